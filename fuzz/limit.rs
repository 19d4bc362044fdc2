//! What a target may hold of memory at once: an input that makes it ask for more ends it.

use std::alloc::System;

use cap::Cap;

#[global_allocator]
static MEMORY: Cap<System> = Cap::new(System, 64 << 20);
