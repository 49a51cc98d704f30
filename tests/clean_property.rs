//! Random soups through clean-up and the whole ladder.

#[path = "drive/clean.rs"]
mod drive;

use drive::{Soup, check};
use proptest::prelude::*;

fn soups() -> impl Strategy<Value = Soup> {
    let point = prop_oneof![20 => [-3i8..4, -3i8..4, -1i8..2], 1 => any::<[i8; 3]>()];
    let face = prop_oneof![
        6 => prop::collection::vec(0u8..12, 3),
        3 => prop::collection::vec(0u8..12, 4..7),
        1 => prop::collection::vec(any::<u8>(), 0..8),
    ];
    (prop::collection::vec(point, 3..13), prop::collection::vec(face, 0..28), 0u8..16)
        .prop_map(|(points, faces, weld)| Soup { points, faces, weld })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    #[test]
    fn cleaning_any_soup_gives_a_valid_mesh_and_an_honest_account(soup in soups()) {
        check(&soup);
    }

    #[test]
    fn any_bytes_drive_the_ladder(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        drive::drive(&bytes);
    }
}
