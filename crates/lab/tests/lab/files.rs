//! The experiments write as the program does: see `phalanx_cli::files`, whose tests run the program.

use phalanx_lab::files::{output, write_whole};
use tempfile::TempDir;

#[test]
fn folders_are_made_and_links_followed() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name);
    write_whole(&at("deep/er/page.md"), b"one").unwrap();
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("deep/er/page.md", at("link")).unwrap();
        write_whole(&at("link"), b"two").unwrap();
        assert!(at("link").symlink_metadata().unwrap().is_symlink());
        assert_eq!(std::fs::read(at("deep/er/page.md")).unwrap(), b"two");
    }
    let page = at("deep/er/page.md");
    let error = output(&at("deep/er/../er/page.md"), &[&page]).unwrap_err();
    assert!(error.to_string().contains("this is the input"), "{error}");
}
