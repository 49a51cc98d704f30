//! Rays, nearest elements and self-intersections of any small mesh, beside rational arithmetic.
#![no_main]

#[path = "../../tests/drive/query.rs"]
mod drive;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| drive::drive(bytes));
