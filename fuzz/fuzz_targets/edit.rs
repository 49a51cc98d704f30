//! Any script of edits, with the naive twin of every operator beside it.
#![no_main]

#[path = "../../tests/drive/edit.rs"]
mod drive;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| drive::drive(bytes));
