//! The peers: an environment of their own, the scripts that run them, and what these print.

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use anyhow::{Context, Result, bail, ensure};

use crate::files;

/// What is installed, and the module that each is imported as.
const PACKAGES: [(&str, &str); 7] = [
    ("numpy", "numpy"),
    ("scipy", "scipy"),
    ("scikit-learn", "sklearn"),
    ("fastrvm", "fastrvm"),
    ("faiss-cpu", "faiss"),
    ("opencv-contrib-python-headless", "cv2"),
    ("numba", "numba"),
];

/// Environment variables that hold a peer to one thread.
const ONE_THREAD: [&str; 5] = [
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "NUMBA_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
];

/// The scripts, and a Python with whatever of the packages could be installed.
pub(crate) struct Peers {
    scripts: PathBuf,
    python: PathBuf,
}

impl Peers {
    /// Makes the environment, or what can be made of it: a peer that is missing fails when it is
    /// run, and its rows say so.
    pub(crate) fn install(scripts: &Path) -> Self {
        let folder = files::in_repository("target/peers");
        let peers = Self { scripts: scripts.to_owned(), python: folder.join("venv/bin/python") };
        if !peers.python.exists() {
            let made =
                Command::new("python3").args(["-m", "venv"]).arg(folder.join("venv")).output();
            if let Err(error) = made.context("python3").and_then(check) {
                eprintln!("no environment for the peers: {error:#}");
                return peers;
            }
        }
        for (package, module) in PACKAGES {
            if peers.run(["-c", &format!("import {module}")]).is_err() {
                eprintln!("installing {package}");
                if let Err(error) = peers.run(["-m", "pip", "install", "--quiet", package]) {
                    eprintln!("{package} is missing: {error:#}");
                }
            }
        }
        peers
    }

    /// A folder for what the scripts write.
    pub(crate) fn data() -> Result<PathBuf> {
        let folder = files::in_repository("target/peers/data");
        std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
        Ok(folder)
    }

    /// The folder of problems that gen_data.py writes.
    pub(crate) fn problems(&self) -> Result<PathBuf> {
        let folder = Self::data()?;
        if !folder.join("hand_x.csv").exists() {
            self.script("gen_data.py", &[&folder.display().to_string()])?;
        }
        Ok(folder)
    }

    /// Runs one of the peers' scripts; returns what it prints.
    pub(crate) fn script(&self, name: &str, arguments: &[&str]) -> Result<String> {
        let path = self.scripts.join(name);
        ensure!(path.is_file(), "there is no {}", path.display());
        self.run(std::iter::once(path.as_os_str()).chain(arguments.iter().map(AsRef::as_ref)))
    }

    /// Runs a program of our own; returns what it prints.
    pub(crate) fn program(&self, name: &str, arguments: &[&str]) -> Result<String> {
        let path = files::in_repository("crates/lab/peers").join(name);
        self.run(std::iter::once(path.as_os_str()).chain(arguments.iter().map(AsRef::as_ref)))
    }

    /// Starts a program of our own that answers line by line.
    pub(crate) fn conversation(&self, name: &str, argument: &Path) -> Result<Conversation> {
        let mut command = self.command();
        command.arg(files::in_repository("crates/lab/peers").join(name)).arg(argument);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut child = command.spawn().context("starting python")?;
        let input = child.stdin.take().context("no way to write to python")?;
        let output = child.stdout.take().context("no way to read from python")?;
        Ok(Conversation { child, input, output: BufReader::new(output), name: name.to_owned() })
    }

    /// A package's version.
    pub(crate) fn version(&self, package: &str) -> Result<String> {
        let code = format!("import importlib.metadata as m; print(m.version('{package}'))");
        Ok(self.run(["-c", &code])?.trim().to_owned())
    }

    /// Each package that should be there, and its version.
    pub(crate) fn versions(&self) -> Vec<(&'static str, Option<String>)> {
        PACKAGES.map(|(package, _)| (package, self.version(package).ok())).to_vec()
    }

    fn command(&self) -> Command {
        let mut command = Command::new(&self.python);
        command.env("PYTHONDONTWRITEBYTECODE", "1");
        command.envs(ONE_THREAD.map(|variable| (variable, "1")));
        command
    }

    fn run<A: AsRef<std::ffi::OsStr>>(
        &self,
        arguments: impl IntoIterator<Item = A>,
    ) -> Result<String> {
        check(self.command().args(arguments).output().context("starting python")?)
    }
}

/// What a program printed, if it succeeded.
fn check(output: std::process::Output) -> Result<String> {
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        bail!("{}", said.trim().lines().last().unwrap_or("it failed without a word"));
    }
    String::from_utf8(output.stdout).context("it printed no text")
}

/// A program that answers each line with a line of numbers.
pub(crate) struct Conversation {
    child: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    name: String,
}

impl Conversation {
    pub(crate) fn ask<const N: usize>(&mut self, question: &str) -> Result<[f64; N]> {
        writeln!(self.input, "{question}").with_context(|| self.name.clone())?;
        let mut answer = String::new();
        self.output.read_line(&mut answer).with_context(|| self.name.clone())?;
        let numbers: Vec<f64> =
            answer.split_whitespace().map(str::parse).collect::<Result<_, _>>()?;
        let found = numbers.len();
        numbers.try_into().ok().with_context(|| format!("{}: {found} numbers, not {N}", self.name))
    }
}

impl Drop for Conversation {
    fn drop(&mut self) {
        // It ends by itself when its input does, unless it hangs.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The number after `key=` in a line of comma-separated fields.
pub(crate) fn field(line: &str, key: &str) -> Result<f64> {
    let value = line.split(',').find_map(|field| field.strip_prefix(key)?.strip_prefix('='));
    let value = value.with_context(|| format!("no {key} in '{line}'"))?;
    value.parse().with_context(|| format!("{key} in '{line}'"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_found_by_their_whole_name() {
        let line = "faiss,N=10,total_s=0.5,iters=25,ms_per_iter=20.0";
        assert_eq!(field(line, "ms_per_iter").unwrap(), 20.0);
        assert_eq!(field(line, "total_s").unwrap(), 0.5);
        assert!(field(line, "per_iter").unwrap_err().to_string().contains("no per_iter"));
    }
}
