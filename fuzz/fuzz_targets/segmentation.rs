#![no_main]
#[path = "../limit.rs"]
mod limit;
#[path = "../targets.rs"]
mod targets;
libfuzzer_sys::fuzz_target!(|data: &[u8]| targets::segmentation(data));
