#![no_main]
#[path = "../limit.rs"]
mod limit;
#[path = "../targets.rs"]
mod targets;
// A decoder's panic is no find, since it is caught; the fuzzer's own hook would end it.
libfuzzer_sys::fuzz_target!(init: std::panic::set_hook(Box::new(|_| ())), |data: &[u8]| {
    targets::picture(data)
});
