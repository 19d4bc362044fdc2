//! The fuzz targets on their corpora, within bounds of time and memory.

#[path = "../../fuzz/targets.rs"]
mod targets;

use std::alloc::System;
use std::path::Path;
use std::time::Duration;

use cap::Cap;
use cpu_time::ThreadTime;

/// Remembers the most that was held at once.
#[global_allocator]
static MEMORY: Cap<System> = Cap::new(System, usize::MAX);

/// What a file may take, whatever it holds.
const MOST_TIME: Duration = Duration::from_secs(1);
const MOST_BYTES: usize = 64 << 20;

#[test]
fn the_corpora_are_sound_or_refused_within_bounds() {
    for (name, target) in targets::TARGETS {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus").join(name);
        let files: Vec<_> = std::fs::read_dir(&folder).expect("a corpus").collect();
        assert!(files.len() >= 3, "{name}: {} files", files.len());
        for file in files {
            let path = file.expect("a file").path();
            let bytes = std::fs::read(&path).expect("its bytes");
            let begun = ThreadTime::now();
            target(&bytes);
            let took = begun.elapsed();
            assert!(took < MOST_TIME, "{}: {took:?}", path.display());
            let held = MEMORY.max_allocated();
            assert!(held < MOST_BYTES, "{}: {held} bytes", path.display());
        }
    }
}
