//! Pages of results in `docs/results/`: every experiment's page begins alike and says how it was made.

use anyhow::Result;

use crate::files;

/// A page that an experiment writes.
pub(crate) struct Page<'a> {
    /// Its file in `docs/results/`.
    pub(crate) file: &'static str,
    /// The command that writes it.
    pub(crate) command: &'a str,
    pub(crate) title: &'static str,
}

impl Page<'_> {
    /// The whole page around its body.
    pub(crate) fn text(&self, body: &str) -> String {
        let Self { command, title, .. } = self;
        format!("<!-- Written by `{command}`; not to be edited. -->\n# {title}\n\n{body}")
    }

    /// Writes the page, and nothing else.
    pub(crate) fn write(&self, body: &str) -> Result<()> {
        let path = files::in_repository("docs/results").join(self.file);
        files::write_whole(&path, self.text(body).as_bytes())
    }

    /// Writes the page and prints it.
    pub(crate) fn publish(&self, body: &str) -> Result<()> {
        self.write(body)?;
        files::print(&self.text(body))
    }
}
