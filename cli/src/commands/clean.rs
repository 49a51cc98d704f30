//! `clean`: the main job.

use crate::account::told;
use crate::args::{Clean, Profile};
use crate::session::{Answer, Failure, Phase, Session};
use crate::text::{self, counted};
use crate::{import, output, progress};
use meshwright::cleanup::{self, Account, CleanOptions, Weld};
use meshwright::io::{Format, Loaded};
use meshwright::{Control, Outcome, PolygonSoup, Step};

pub(super) fn clean(session: &mut Session, args: &Clean) -> Result<Answer, Failure> {
    args.output.format()?;
    let Loaded { soup: file, notes } = import::load(session, &args.file)?;
    let (profile, usual) = match args.profile {
        Profile::Preserve => (cleanup::Profile::Preserve, Weld::Exact),
        Profile::Solid => (cleanup::Profile::Solid, Weld::Auto),
    };
    let weld = args.weld.unwrap_or(usual);
    let outcome = session.timed(Phase::Run, || {
        progress::shown(|hook| {
            let options = CleanOptions { profile, weld, debris: args.debris, control: Control::new(hook) };
            cleanup::clean_indexed(&file, options)
        })
    })?;
    let Outcome { value, report, maps } = outcome;
    let not_carried = text::not_carried(&report);
    let account =
        session.timed(Phase::Run, || Account::new(&file, (profile, weld), &value, report, &maps))?;
    drop(file);
    let soup: PolygonSoup = session.timed(Phase::Run, || value.into());
    // All files are complete before the first is put in its place.
    let (staged, lost) = output::stage_mesh(session, &args.output, &soup)?;
    let mut staged = vec![staged];
    if let Some(path) = &args.maps {
        staged.push(session.timed(Phase::Write, || output::stage_json(path, &maps))?);
    }
    let remerged = if args.output.format()? == Format::Stl { at_one_place(&soup)? } else { 0 };
    // A million records in JSON need the room.
    drop((soup, maps));
    let json = session
        .fields(args.report.is_some())
        .with_all(&account)
        .with("notes", &notes)
        .with("lost", &lost)
        .with("remerged_vertices", &remerged);
    if let Some(path) = &args.report {
        staged.push(output::stage_with(path, |sink| session.write_object(&json, sink))?);
    }
    for file in staged {
        file.commit()?;
    }
    let mut text = told(&account);
    for line in not_carried {
        text.push_str(&format!("{line}\n"));
    }
    text.push_str(&format!("\nwrote {}\n", args.output.output.display()));
    let split = account.steps.iter().any(|s| s.step == Step::SplitVertices && s.changed > 0);
    if remerged > 0 {
        let vertices = counted(remerged, "vertex");
        text.push_str(&format!(
            "STL knows no vertices: {vertices} at the place of others will merge when it is read; PLY and OBJ keep them\n"
        ));
    } else if split {
        text.push_str("vertices that were split lie at one place: look at the result with --weld none\n");
    }
    Ok(Answer { json, text, is_no: profile == cleanup::Profile::Solid && !account.solid })
}

/// How many vertices lie where an earlier one does.
fn at_one_place(soup: &PolygonSoup) -> Result<usize, Failure> {
    let welded = cleanup::index(soup, Weld::Exact)?;
    Ok(soup.positions.len().saturating_sub(welded.value.vertex_count()))
}
