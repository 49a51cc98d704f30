//! `clean`: the main job.

use crate::args::{Clean, Profile};
use crate::session::{Answer, Failure, Phase, Session};
use crate::text::{self, counted};
use crate::{import, output, progress};
use meshwright::cleanup::{self, Account, CleanOptions, Facts, Weld};
use meshwright::{Control, Outcome, PolygonSoup, Step};

pub(super) fn clean(session: &mut Session, args: &Clean) -> Result<Answer, Failure> {
    args.output.format()?;
    let loaded = import::load(session, &args.file)?;
    let (profile, usual) = match args.profile {
        Profile::Preserve => (cleanup::Profile::Preserve, Weld::Exact),
        Profile::Solid => (cleanup::Profile::Solid, Weld::Auto),
    };
    let weld = args.weld.unwrap_or(usual);
    let outcome = session.timed(Phase::Run, || {
        progress::shown(|hook| {
            let options = CleanOptions { profile, weld, debris: args.debris, control: Control::new(hook) };
            cleanup::clean_indexed(&loaded.soup, options)
        })
    })?;
    let Outcome { value, report, maps } = outcome;
    let account =
        session.timed(Phase::Run, || Account::new(&loaded.soup, (profile, weld), &value, &report, &maps))?;
    let soup: PolygonSoup = session.timed(Phase::Run, || value.into());
    // All files are complete before the first is put in its place.
    let (staged, lost) = output::stage_mesh(session, &args.output, &soup)?;
    let mut staged = vec![staged];
    if let Some(path) = &args.maps {
        staged.push(session.timed(Phase::Write, || output::stage_json(path, &maps))?);
    }
    let json = session
        .fields(args.report.is_some())
        .with_all(&account)
        .with("notes", &loaded.notes)
        .with("lost", &lost);
    if let Some(path) = &args.report {
        let object = session.object(json.clone());
        staged.push(session.timed(Phase::Write, || output::stage_text(path, &object))?);
    }
    for file in staged {
        file.commit()?;
    }
    let mut text = String::new();
    let mut lines = text::changes(&report);
    if lines.is_empty() {
        lines.push("nothing had to be changed".to_owned());
    }
    lines.extend(text::not_carried(&report));
    for line in lines {
        text.push_str(&line);
        text.push('\n');
    }
    text.push_str(&format!(
        "wrote {}\nbefore: {}\nafter:  {}\n",
        args.output.output.display(),
        summary(&account.before),
        summary(&account.after)
    ));
    let split = report.steps.iter().any(|s| s.step == Step::SplitVertices && s.changed > 0);
    if split && weld != Weld::None {
        text.push_str("vertices that were split lie at one place: look at the result with --weld none\n");
    }
    Ok(Answer { json, text, is_no: profile == cleanup::Profile::Solid && !account.solid })
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
