//! `clean`: the main job.

use crate::args::{Clean, Profile};
use crate::session::{Answer, Failure, Phase, Session};
use crate::text::{self, counted};
use crate::{import, output, progress};
use meshwright::cleanup::{self, CleanError, CleanOptions, Facts, Weld};
use meshwright::{Control, PolygonSoup, Step};

pub(super) fn clean(session: &mut Session, args: &Clean) -> Result<Answer, Failure> {
    args.output.format()?;
    let loaded = import::load(session, &args.file)?;
    let Profile::Preserve = args.profile;
    let before = inspect(session, &loaded.soup, args.weld)?;
    let outcome = session.timed(Phase::Run, || {
        progress::shown(|hook| {
            let options = CleanOptions { weld: args.weld, control: Control::new(hook), ..Default::default() };
            cleanup::clean_indexed(&loaded.soup, options)
        })
    })?;
    let soup: PolygonSoup = session.timed(Phase::Run, || outcome.value.into());
    // Splits leave vertices at one place, so the result is looked at as it is.
    let after = inspect(session, &soup, Weld::None)?;
    // All files are complete before the first is put in its place.
    let (staged, lost) = output::stage_mesh(session, &args.output, &soup)?;
    let mut staged = vec![staged];
    if let Some(path) = &args.maps {
        staged.push(session.timed(Phase::Write, || output::stage_json(path, &outcome.maps))?);
    }
    let report = &outcome.report;
    let json = session
        .fields(args.report.is_some())
        .with("schema", &1)
        .with("counts", &report.counts())
        .with("steps", &report.steps)
        .with("not_carried", &report.not_carried)
        .with("lost_values", &import::lost_values(report))
        .with("before", &before)
        .with("after", &after)
        .with("notes", &loaded.notes)
        .with("lost", &lost)
        .with("defects", &report.records);
    if let Some(path) = &args.report {
        let object = session.object(json.clone());
        staged.push(session.timed(Phase::Write, || output::stage_text(path, &object))?);
    }
    for file in staged {
        file.commit()?;
    }
    let mut text = String::new();
    let mut lines = text::changes(report);
    if lines.is_empty() {
        lines.push("nothing had to be changed".to_owned());
    }
    lines.extend(text::not_carried(report));
    for line in lines {
        text.push_str(&line);
        text.push('\n');
    }
    text.push_str(&format!(
        "wrote {}\nbefore: {}\nafter:  {}\n",
        args.output.output.display(),
        summary(&before),
        summary(&after)
    ));
    let split = report.steps.iter().any(|s| s.step == Step::SplitVertices && s.changed > 0);
    if split && args.weld != Weld::None {
        text.push_str("vertices that were split lie at one place: look at the result with --weld none\n");
    }
    Ok(Answer { json, text, is_no: false })
}

fn inspect(session: &mut Session, soup: &PolygonSoup, weld: Weld) -> Result<Facts, CleanError> {
    session
        .timed(Phase::Run, || progress::shown(|hook| cleanup::inspect_with(soup, weld, Control::new(hook))))
}

fn summary(f: &Facts) -> String {
    let is = |yes: bool, name: &str| if yes { name.to_owned() } else { format!("not {name}") };
    format!(
        "{}, {}, {}, {}, {}, {}",
        counted(f.vertices, "vertex"),
        counted(f.faces, "face"),
        counted(f.components, "component"),
        is(f.closed, "closed"),
        is(f.manifold, "manifold"),
        is(f.oriented, "oriented")
    )
}
