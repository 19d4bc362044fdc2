//! Where results go: written whole or not at all, and never over what they are made of.

use std::fs::{File, Metadata, OpenOptions};
use std::io::{ErrorKind, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use image::{ImageFormat, RgbImage};

/// How many symbolic links are followed from one to the next, as most systems do.
const MOST_LINKS: usize = 40;

/// A place for a result: a file, or standard output for `-`.
///
/// Symbolic links are followed. A file is replaced by a complete one with the same mode; one that has
/// other names too (hard links), or another owner, is written in place. What is no regular file, such
/// as a pipe or a device, is written through.
#[derive(Debug, Clone)]
pub struct Output {
    /// As it was given.
    path: PathBuf,
    place: Place,
}

#[derive(Debug, Clone)]
enum Place {
    StandardOutput,
    /// A pipe, a device, a socket.
    Stream(PathBuf),
    /// A file that is there or not, no link.
    File(PathBuf),
}

impl Output {
    /// The place of this name, for a result that is made of some inputs, files or folders of pictures. Nothing
    /// is written yet.
    ///
    /// # Errors
    /// A folder, a file that is read-only or one of the inputs, a place in a folder that is not there,
    /// links that lead in a circle.
    pub fn new(path: &Path, inputs: &[impl AsRef<Path>]) -> Result<Self> {
        let place = if path == Path::new("-") { Place::StandardOutput } else { place(path)? };
        let output = Self { path: path.to_owned(), place };
        if let Place::File(target) = &output.place
            && let Some(input) = inputs.iter().find(|input| is_input(target, input.as_ref()))
        {
            bail!(
                "{}: this is the input {}; choose another name for the output",
                path.display(),
                input.as_ref().display()
            );
        }
        Ok(output)
    }

    /// Refuses the place of another result of the same run.
    ///
    /// # Errors
    /// The same place.
    pub fn check_apart(&self, other: &Self) -> Result<()> {
        let is_same = match (&self.place, &other.place) {
            (Place::StandardOutput, Place::StandardOutput) => true,
            (Place::File(one), Place::File(other)) => {
                is_same_file(one, other)
                    || one.file_name() == other.file_name()
                        && is_same_file(folder_of(one), folder_of(other))
            }
            _ => false,
        };
        ensure!(!is_same, "{}: another result goes there; choose two names", self.path.display());
        Ok(())
    }

    /// Whether it is standard output, where nothing else may be printed then.
    pub fn is_standard_output(&self) -> bool {
        matches!(self.place, Place::StandardOutput)
    }

    /// The place as it was named.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether it is a file, whose name may have to tell its format.
    pub fn is_file(&self) -> bool {
        matches!(self.place, Place::File(_))
    }

    /// Writes the result. A file is complete afterwards, or as it was before.
    ///
    /// # Errors
    /// What the system says of the place, such as a full disk or a folder that may not be written to.
    pub fn write(&self, bytes: &[u8]) -> Result<()> {
        let written = match &self.place {
            Place::StandardOutput => to_standard_output(bytes),
            Place::Stream(target) => {
                OpenOptions::new().write(true).open(target).and_then(|mut it| it.write_all(bytes))
            }
            Place::File(target) => to_file(target, bytes),
        };
        written.with_context(|| format!("writing {}", self.path.display()))
    }

    /// The name beside the file that has `end` after the file's own; `None` where it is no file.
    pub fn beside(&self, end: &str) -> Option<PathBuf> {
        let Place::File(target) = &self.place else { return None };
        let mut name = target.as_os_str().to_owned();
        name.push(end);
        Some(PathBuf::from(name))
    }

    /// Opens what is no file, for a result that is written as it comes; `None` of a file.
    ///
    /// # Errors
    /// What the system says of the place.
    pub fn stream(&self) -> Result<Option<Box<dyn Write>>> {
        Ok(match &self.place {
            Place::StandardOutput => Some(Box::new(std::io::stdout())),
            Place::Stream(target) => {
                let opened = OpenOptions::new().write(true).open(target);
                Some(Box::new(opened.with_context(|| format!("writing {}", self.path.display()))?))
            }
            Place::File(_) => None,
        })
    }

    /// Puts a complete file that lies [`beside`](Self::beside) it in the file's place.
    ///
    /// # Errors
    /// What the system says of the place.
    pub fn replace_by(&self, file: &Path) -> Result<()> {
        let Place::File(target) = &self.place else { return Ok(()) };
        moved(file, target).with_context(|| format!("writing {}", self.path.display()))
    }

    /// Writes a picture as PNG.
    ///
    /// # Errors
    /// As of [`write`](Self::write).
    pub fn write_png(&self, picture: &RgbImage) -> Result<()> {
        let mut png = std::io::Cursor::new(Vec::new());
        let encoded = picture.write_to(&mut png, ImageFormat::Png);
        encoded.with_context(|| format!("writing {}", self.path.display()))?;
        self.write(png.get_ref())
    }

    /// Says something about the result that was written, a line: on standard output, or where the
    /// result is there, on standard error.
    ///
    /// # Errors
    /// Standard output that is closed.
    pub fn say(&self, text: &str) -> Result<()> {
        if self.is_standard_output() {
            eprintln!("{text}");
            return Ok(());
        }
        print(&format!("{}: {text}\n", self.path.display()))
    }
}

/// Writes a result to standard output.
///
/// # Errors
/// Standard output that is closed.
pub fn print(result: &str) -> Result<()> {
    to_standard_output(result.as_bytes()).context("writing the result")
}

fn to_standard_output(bytes: &[u8]) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    out.write_all(bytes).and_then(|()| out.flush())
}

/// What a path leads to.
fn place(path: &Path) -> Result<Place> {
    let name = || path.display().to_string();
    let target = follow(path)?;
    match std::fs::metadata(&target) {
        Ok(found) if found.is_dir() => bail!("{}: this is a folder; name a file in it", name()),
        Ok(found) if !found.is_file() => Ok(Place::Stream(target)),
        Ok(found) if found.permissions().readonly() => {
            bail!("{}: this file is read-only; choose another name or make it writable", name())
        }
        Ok(_) => Ok(Place::File(target)),
        Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
            let folder = folder_of(&target);
            ensure!(folder.is_dir(), "{}: there is no folder {}", name(), folder.display());
            ensure!(target.file_name().is_some(), "{}: this is no name of a file", name());
            Ok(Place::File(target))
        }
        Err(error) => Err(error).with_context(name),
    }
}

/// Follows symbolic links, also to what is not there yet.
fn follow(path: &Path) -> Result<PathBuf> {
    let mut target = path.to_owned();
    for _ in 0..MOST_LINKS {
        match std::fs::read_link(&target) {
            Ok(next) => target = folder_of(&target).join(next),
            // No link, or nothing.
            Err(_) => return Ok(target),
        }
    }
    bail!("{}: symbolic links lead from one to the next without end", path.display())
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Whether a file is an input, or a picture in a folder that is one.
fn is_input(target: &Path, input: &Path) -> bool {
    let is_picture = || target.is_file() && ImageFormat::from_path(target).is_ok();
    is_same_file(target, input) || is_picture() && is_same_file(folder_of(target), input)
}

/// Writes a file so that it is complete afterwards, or as it was before.
fn to_file(target: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let old = std::fs::metadata(target).ok();
    let folder = folder_of(target);
    let named = |error: std::io::Error| {
        std::io::Error::new(error.kind(), format!("folder {}: {error}", folder.display()))
    };
    if old.as_ref().is_some_and(has_other_names) {
        return in_place(target, bytes);
    }
    let mut file = readable_by_others().tempfile_in(folder).map_err(named)?;
    if let Some(old) = &old {
        if !has_same_owner(old, &file.as_file().metadata()?) {
            return in_place(target, bytes);
        }
        file.as_file().set_permissions(old.permissions())?;
    }
    file.write_all(bytes)?;
    // Some systems notice only now that the disk is full.
    file.as_file().sync_all()?;
    file.persist(target)?;
    Ok(())
}

/// Moves a complete file to the place of another, as [`to_file`] puts bytes there.
fn moved(file: &Path, target: &Path) -> std::io::Result<()> {
    let opened = File::open(file)?;
    if let Ok(old) = std::fs::metadata(target) {
        if has_other_names(&old) || !has_same_owner(&old, &opened.metadata()?) {
            in_place(target, &std::fs::read(file)?)?;
            return std::fs::remove_file(file);
        }
        opened.set_permissions(old.permissions())?;
    }
    opened.sync_all()?;
    std::fs::rename(file, target)
}

/// Overwrites a file. What is longer than before comes first: if there is no room for it, the file
/// keeps what it held.
fn in_place(target: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let mut file = OpenOptions::new().write(true).open(target)?;
    let old = file.metadata()?.len();
    let (head, tail) = bytes.split_at(bytes.len().min(usize::try_from(old).unwrap_or(usize::MAX)));
    let grown = file.seek(SeekFrom::Start(old)).and_then(|_| file.write_all(tail));
    if let Err(error) = grown.and_then(|()| file.sync_all()) {
        file.set_len(old)?;
        return Err(error);
    }
    file.rewind()?;
    file.write_all(head)?;
    file.set_len(bytes.len() as u64)?;
    file.sync_all()
}

/// Temporary files are private unless it is said otherwise; results are not, as far as the umask
/// allows.
fn readable_by_others() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder
}

#[cfg(unix)]
fn has_other_names(file: &Metadata) -> bool {
    std::os::unix::fs::MetadataExt::nlink(file) > 1
}

#[cfg(unix)]
fn has_same_owner(one: &Metadata, other: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    (one.uid(), one.gid()) == (other.uid(), other.gid())
}

/// Whether two names are one file's.
#[cfg(unix)]
fn is_same_file(one: &Path, other: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let number = |path: &Path| std::fs::metadata(path).ok().map(|file| (file.dev(), file.ino()));
    number(one).is_some_and(|own| number(other) == Some(own))
}

#[cfg(not(unix))]
fn has_other_names(_: &Metadata) -> bool {
    false
}

#[cfg(not(unix))]
fn has_same_owner(_: &Metadata, _: &Metadata) -> bool {
    true
}

/// Whether two names are one file's.
#[cfg(not(unix))]
fn is_same_file(one: &Path, other: &Path) -> bool {
    let place = |path: &Path| path.canonicalize().ok();
    place(one).is_some_and(|own| place(other) == Some(own))
}
