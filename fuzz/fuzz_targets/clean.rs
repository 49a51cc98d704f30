//! Any soup through clean-up and the whole ladder, twice.
#![no_main]

#[path = "../../tests/drive/clean.rs"]
mod drive;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| drive::drive(bytes));
