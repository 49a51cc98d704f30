//! The progress-and-cancel hook of calls that have it in a twin: wherever they are stopped, they say so.

mod shapes;

use meshwright::cleanup::{CleanError, Weld, index, index_with, inspect, inspect_with};
use meshwright::glam::DVec3;
use meshwright::io::{
    self, Encoding, Format, Limits, ReadError, WriteError, read_file_with, read_with, write_with,
};
use meshwright::{
    BuildWithError, Control, IndexedMesh, Mesh, PolygonSoup, Polygons, Progress, UnifyWithError,
    unify_winding, unify_winding_with,
};
use std::ops::ControlFlow;

/// Runs a call to its end, and then stopped at its reports, or at some of them if there are many. Returns how many.
fn stop_everywhere<T: PartialEq, E>(
    name: &str,
    expected: &T,
    run: impl Fn(Control<'_>) -> Result<T, E>,
    is_cancelled: impl Fn(&E) -> bool,
) -> usize {
    let mut seen = Vec::new();
    let mut watch = |p: Progress| {
        seen.push(p.fraction);
        ControlFlow::Continue(())
    };
    match run(Control::new(&mut watch)) {
        Ok(value) => assert!(value == *expected, "{name}: the same as without a hook"),
        Err(_) => panic!("{name}: refused"),
    }
    assert!(seen.is_sorted() && seen.len() >= 2, "{name}: {seen:?}");
    assert!(seen.iter().all(|f| (0.0..=1.0).contains(f)), "{name}: {seen:?}");
    for stop in (0..seen.len()).step_by(seen.len().div_ceil(6)) {
        let mut count = 0;
        let mut hook = |_: Progress| {
            count += 1;
            if count > stop { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        match run(Control::new(&mut hook)) {
            Err(error) => assert!(is_cancelled(&error), "{name}, {stop}"),
            Ok(_) => panic!("{name}, {stop}: went on"),
        }
        assert_eq!(count, stop + 1, "{name}: it is asked no more");
    }
    seen.len()
}

/// Triangles that share nothing, some wound the other way; 270,000 of them are enough to be asked on the way.
fn triangles(count: u32) -> PolygonSoup {
    let point = |i: u32| DVec3::new(f64::from(i / 3), f64::from(i % 3), f64::from(i % 3 / 2));
    let faces: Vec<[u32; 3]> = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    PolygonSoup::new((0..3 * count).map(point).collect(), Polygons::from_triangles(&faces))
}

#[test]
fn reading_and_writing_stop_where_they_are_told() {
    let soup = triangles(270_000);
    for (format, encoding) in [
        (Format::Obj, Encoding::Ascii),
        (Format::Stl, Encoding::Binary),
        (Format::Stl, Encoding::Ascii),
        (Format::Ply, Encoding::Binary),
        (Format::Ply, Encoding::BigEndian),
        (Format::Ply, Encoding::Ascii),
        (Format::Off, Encoding::Ascii),
    ] {
        let name = format!("{format:?}, {encoding:?}");
        let mut file = Vec::new();
        let lost = io::write(&soup, format, encoding, &mut file).expect("written");
        let write = |control: Control<'_>| {
            let mut again = Vec::new();
            write_with(&soup, format, encoding, &mut again, control).map(|lost| (lost, again == file))
        };
        let expected = (lost, true);
        let is_cancelled = |e: &WriteError| matches!(e, WriteError::Cancelled(_));
        let reports = stop_everywhere(&format!("write {name}"), &expected, write, is_cancelled);
        assert!(reports > 5, "{name}: {reports} reports");
        let limits = Limits::default();
        let expected = io::read(&file, format, &limits).expect("read");
        let read = |control: Control<'_>| read_with(&file, format, &limits, control);
        let is_cancelled = |e: &ReadError| matches!(e, ReadError::Cancelled(_));
        let reports = stop_everywhere(&format!("read {name}"), &expected, read, is_cancelled);
        assert!(reports > 2, "{name}: {reports} reports");
    }
}

#[test]
fn a_cancelled_reading_of_a_binary_off_and_of_a_file_on_disk_says_so() {
    let mut file = b"OFF BINARY\n".to_vec();
    let count = 300_000u32;
    [count, 1, 0].iter().for_each(|n| file.extend(n.to_be_bytes()));
    (0..3 * count).for_each(|i| file.extend((i as f32).to_be_bytes()));
    [3u32, 0, 1, 2].iter().for_each(|n| file.extend(n.to_be_bytes()));
    let limits = Limits::default();
    let expected = io::read(&file, Format::Off, &limits).expect("read");
    let is_cancelled = |e: &ReadError| matches!(e, ReadError::Cancelled(_));
    let read = |control: Control<'_>| read_with(&file, Format::Off, &limits, control);
    stop_everywhere("OFF BINARY", &expected, read, is_cancelled);
    // The example holds a NaN, which equals nothing.
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/broken_bracket.obj");
    let expected = io::read_file(path, &limits).expect("read").notes;
    let read = |control: Control<'_>| read_file_with(path, &limits, control).map(|loaded| loaded.notes);
    assert!(stop_everywhere("a file", &expected, read, is_cancelled) >= 3);
}

#[test]
fn an_error_of_the_file_before_the_stop_is_told_and_one_behind_it_is_not() {
    let mut hook = |_: Progress| ControlFlow::Continue(());
    let bad = b"v 0 0 x\nf 1 1 1\n";
    let refused = read_with(bad, Format::Obj, &Limits::default(), Control::new(&mut hook));
    assert!(matches!(refused, Err(ReadError::Malformed { .. })));
    let mut stop = |_: Progress| ControlFlow::Break(());
    let refused = read_with(bad, Format::Obj, &Limits::default(), Control::new(&mut stop));
    assert!(matches!(refused, Err(ReadError::Cancelled(_))));
}

#[test]
fn cleanup_without_a_result_stops_where_it_is_told() {
    let is_cancelled = |e: &CleanError| matches!(e, CleanError::Cancelled(_));
    for soup in [triangles(180_000), shapes::cube().into()] {
        for weld in [Weld::Exact, Weld::Within(1e-3)] {
            let expected = inspect(&soup, weld).expect("always answers");
            let run = |control: Control<'_>| inspect_with(&soup, weld, control);
            stop_everywhere("inspect", &expected, run, is_cancelled);
            let expected = index(&soup, weld).expect("always answers").value;
            let run = |control: Control<'_>| index_with(&soup, weld, control).map(|o| o.value);
            stop_everywhere("index", &expected, run, is_cancelled);
        }
    }
}

#[test]
fn building_and_unifying_stop_where_they_are_told() {
    let pool = shapes::icosphere(2);
    let build = |control: Control<'_>| Mesh::build_with(&pool, control).map(|m| m.to_indexed());
    stop_everywhere("build", &pool, build, |e| matches!(e, BuildWithError::Cancelled(_)));
    let mut mixed = pool.polygons().clone();
    (0..mixed.len()).step_by(3).for_each(|f| mixed.reverse(f));
    let mixed = IndexedMesh::new(pool.positions().to_vec(), mixed).expect("valid");
    let topology = mixed.topology();
    let expected = unify_winding(&topology).expect("a sphere").value;
    let unify = |control: Control<'_>| unify_winding_with(&topology, control).map(|o| o.value);
    stop_everywhere("unify", &expected, unify, |e| matches!(e, UnifyWithError::Cancelled(_)));
}

#[test]
fn a_refusal_under_a_hook_is_the_refusal_without_it() {
    let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
    let mixed = IndexedMesh::from_triangles(points, &[[0, 1, 2], [1, 2, 3]]).expect("valid");
    let error = Mesh::build(&mixed).expect_err("a conflict");
    let mut hook = |_: Progress| ControlFlow::Continue(());
    let refused = Mesh::build_with(&mixed, Control::new(&mut hook)).expect_err("a conflict");
    assert_eq!(refused, BuildWithError::Refused(error));
    let strip = shapes::moebius(5);
    let error = unify_winding(&strip.topology()).expect_err("a Moebius strip");
    let refused = unify_winding_with(&strip.topology(), Control::none()).expect_err("a Moebius strip");
    assert_eq!(refused, UnifyWithError::Refused(error));
}
