//! Makes `examples/data/broken_bracket.obj`: an angle bracket as a careless exporter might leave it.
//!
//! Run from the repository's root: `cargo run --example make_sample`.

use std::fmt::Write;

/// The outline of the bracket's side, counter-clockwise.
const OUTLINE: [[f64; 2]; 6] = [[0., 0.], [40., 0.], [40., 6.], [6., 6.], [6., 30.], [0., 30.]];
const WIDTH: f64 = 20.0;

/// The text of the file.
pub(crate) fn sample() -> String {
    let mut text =
        String::from("# An angle bracket, badly exported: see examples/make_sample.rs\ng bracket\n");
    let mut count = 0;
    // Every face brings vertices of its own.
    let mut face = |text: &mut String, corners: &[[f64; 3]]| {
        for [x, y, z] in corners {
            let _ = writeln!(text, "v {x} {y} {z}");
        }
        let indices: Vec<String> = (count + 1..=count + corners.len()).map(|i| i.to_string()).collect();
        let _ = writeln!(text, "f {}", indices.join(" "));
        count += corners.len();
    };
    let front: Vec<[f64; 3]> = OUTLINE.iter().map(|&[x, y]| [x, y, WIDTH]).collect();
    let back: Vec<[f64; 3]> = OUTLINE.iter().rev().map(|&[x, y]| [x, y, 0.0]).collect();
    face(&mut text, &front);
    face(&mut text, &back);
    for (i, &[x, y]) in OUTLINE.iter().enumerate() {
        let [u, v] = OUTLINE[(i + 1) % OUTLINE.len()];
        let mut side = [[x, y, 0.0], [u, v, 0.0], [u, v, WIDTH], [x, y, WIDTH]];
        if i % 3 == 1 {
            // Two sides are wound the wrong way.
            side.reverse();
        }
        face(&mut text, &side);
        if i == 4 {
            // One is there twice.
            face(&mut text, &side);
        }
    }
    // A block that touches the bracket along an edge.
    text.push_str("g block\n");
    let corner =
        |i: usize| [40.0 + 8.0 * (i & 1) as f64, 6.0 + 8.0 * (i >> 1 & 1) as f64, WIDTH * (i >> 2) as f64];
    for quad in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
        face(&mut text, &quad.map(corner));
    }
    text.push_str("g rubbish\n");
    // A triangle without area, one with a vertex that is no number, one that names a vertex that is not there, and a
    // vertex that nobody names.
    face(&mut text, &[[0., 0., 0.], [40., 0., 0.], [0., 0., 0.]]);
    face(&mut text, &[[0., 0., 0.], [f64::NAN, 0., 0.], [0., 30., 0.]]);
    text.push_str("f 1 2 9999\nv 100 100 100\n");
    text
}

#[allow(dead_code, reason = "the tests take the text and leave the file alone")]
fn main() -> std::io::Result<()> {
    std::fs::write("examples/data/broken_bracket.obj", sample())
}
