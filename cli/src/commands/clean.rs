//! `clean`: the main job.

use super::look::fields;
use crate::args::{Clean, Profile};
use crate::session::{Answer, Failure, Phase, Session};
use crate::{import, output, progress};
use meshwright::cleanup::{self, CleanOptions, Facts, Weld};
use meshwright::{Control, PolygonSoup};
use serde_json::json;

pub(super) fn clean(session: &mut Session, args: &Clean) -> Result<Answer, Failure> {
    args.output.format()?;
    let loaded = import::load(session, &args.file)?;
    let Profile::Preserve = args.profile;
    let before = session.timed(Phase::Run, || cleanup::inspect(&loaded.soup, args.weld))?;
    let outcome = session.timed(Phase::Run, || {
        progress::shown(|hook| {
            let options = CleanOptions { weld: args.weld, control: Control::new(hook), ..Default::default() };
            cleanup::clean_indexed(&loaded.soup, options)
        })
    })?;
    let soup: PolygonSoup = session.timed(Phase::Run, || outcome.value.into());
    // Splits leave vertices at one place, so the result is looked at as it is.
    let after = session.timed(Phase::Run, || cleanup::inspect(&soup, Weld::None))?;
    let lost = output::write_mesh(session, &args.output, &soup)?;
    if let Some(path) = &args.maps {
        session.timed(Phase::Write, || output::write_json(path, &outcome.maps))?;
    }
    let report = &outcome.report;
    let json = fields(json!({
        "schema": 1,
        "counts": report.counts(),
        "steps": report.steps,
        "not_carried": report.not_carried,
        "lost_values": import::lost_values(report),
        "before": before,
        "after": after,
        "notes": loaded.notes,
        "lost": lost,
    }));
    let defects = serde_json::to_string(&report.records).map_err(Failure::refused)?;
    let list = Some(("defects", defects));
    if let Some(path) = &args.report {
        let object = session.object(json.clone(), list.as_ref());
        session.timed(Phase::Write, || output::write_text(path, &object))?;
    }
    let mut text = String::new();
    let changes = import::changes(report);
    if changes.is_empty() {
        text.push_str("nothing had to be changed\n");
    }
    for line in changes {
        text.push_str(&line);
        text.push('\n');
    }
    text.push_str(&format!(
        "wrote {}\nbefore: {}\nafter:  {}\n",
        args.output.output.display(),
        summary(&before),
        summary(&after)
    ));
    Ok(Answer { json, list, text, is_no: false })
}

fn summary(f: &Facts) -> String {
    let is = |yes: bool, name: &str| if yes { name.to_owned() } else { format!("not {name}") };
    format!(
        "{} vertices, {} faces, {} components, {}, {}, {}",
        f.vertices,
        f.faces,
        f.components,
        is(f.closed, "closed"),
        is(f.manifold, "manifold"),
        is(f.oriented, "oriented")
    )
}
