//! Bytes through the off reader and every writer.
#![no_main]

#[path = "../../tests/drive/io.rs"]
mod drive;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| drive::off(bytes));
