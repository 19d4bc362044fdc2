//! The fuzz targets on their corpora.

#[path = "../../fuzz/targets.rs"]
mod targets;

use std::path::Path;

#[test]
fn the_corpora_are_sound_or_refused() {
    for (name, target) in targets::TARGETS {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus").join(name);
        let files: Vec<_> = std::fs::read_dir(&folder).expect("a corpus").collect();
        assert!(files.len() >= 3, "{name}: {} files", files.len());
        for file in files {
            target(&std::fs::read(file.expect("a file").path()).expect("its bytes"));
        }
    }
}
