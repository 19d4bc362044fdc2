//! Slurm on this computer alone: one controller, one node, no munge.

use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::installed::run;
use crate::work::Work;

/// How long to wait for something that should come soon.
const LONG: Duration = Duration::from_mins(10);
const SHORT: Duration = Duration::from_millis(200);

pub(crate) struct Slurm<'a> {
    work: &'a Work,
    folder: PathBuf,
    daemons: Vec<Child>,
}

impl<'a> Slurm<'a> {
    pub(crate) fn start(work: &'a Work) -> Self {
        let folder = work.path("slurm");
        for name in ["state", "spool"] {
            std::fs::create_dir_all(folder.join(name)).expect("a folder");
        }
        std::fs::write(folder.join("slurm.conf"), configuration(&folder)).expect("a configuration");
        let mut slurm = Self { work, folder, daemons: Vec::new() };
        for daemon in ["slurmctld", "slurmd"] {
            let mut command = slurm.command(daemon);
            command.arg("-D").stdout(Stdio::null()).stderr(Stdio::null());
            slurm.daemons.push(command.spawn().expect("it starts"));
        }
        slurm.wait_until("the node is up", || {
            let states = slurm.command("sinfo").args(["--noheader", "--format=%t"]).output();
            states.is_ok_and(|states| states.stdout.starts_with(b"idle"))
        });
        slurm
    }

    /// Runs a job array to its end, whether its jobs succeed or not.
    pub(crate) fn run(&self, array: &str, script: &Path, arguments: &[&str]) {
        let mut sbatch = self.command("sbatch");
        sbatch.args([
            "--parsable",
            "--output=job-%A-%a.txt",
            "--cpus-per-task=1",
            "--array",
            array,
        ]);
        let job = run(sbatch.arg(script).args(arguments));
        let job = job.trim();
        self.wait_until("the jobs have ended", || {
            let left = self.command("squeue").args(["--noheader", "--jobs", job]).output();
            left.is_ok_and(|left| left.status.success() && left.stdout.is_empty())
        });
    }

    /// What the jobs said.
    pub(crate) fn said(&self) -> String {
        let files = std::fs::read_dir(self.work.path("")).expect("a folder");
        let files = files.map(|file| file.expect("a file").path());
        let jobs = files.filter(|path| path.extension().is_some_and(|end| end == "txt"));
        jobs.map(|path| std::fs::read_to_string(path).unwrap_or_default()).collect()
    }

    fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command.env("SLURM_CONF", self.folder.join("slurm.conf"));
        command.env("PATH", self.work.search_path()).current_dir(self.work.path(""));
        command
    }

    fn wait_until(&self, what: &str, holds: impl Fn() -> bool) {
        let begun = Instant::now();
        while !holds() {
            let logs = ["controller", "node"].map(|name| {
                std::fs::read_to_string(self.folder.join(name).with_extension("log"))
                    .unwrap_or_default()
            });
            assert!(begun.elapsed() < LONG, "not after {LONG:?}: {what}\n{}", logs.concat());
            sleep(SHORT);
        }
    }
}

impl Drop for Slurm<'_> {
    fn drop(&mut self) {
        // Jobs outlive the daemons.
        let user = run(Command::new("id").arg("-un"));
        let _ = self
            .command("scancel")
            .args(["--full", "--signal=KILL", "--user"])
            .arg(user.trim())
            .output();
        for daemon in self.daemons.iter_mut().rev() {
            // It may have ended by itself.
            let _ = daemon.kill();
            let _ = daemon.wait();
        }
    }
}

fn configuration(folder: &Path) -> String {
    let one_line = |command: &mut Command| run(command).trim().to_owned();
    let host = one_line(Command::new("hostname").arg("-s"));
    let user = one_line(Command::new("id").arg("-un"));
    let [controller, node] = free_ports();
    let folder = folder.display();
    format!(
        "\
ClusterName=one
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller}
SlurmdPort={node}
AuthType=auth/none
CredType=cred/none
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SlurmUser={user}
SlurmdUser={user}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/controller.pid
SlurmdPidFile={folder}/node.pid
SlurmctldLogFile={folder}/controller.log
SlurmdLogFile={folder}/node.log
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
SchedulerParameters=sched_interval=1,batch_sched_delay=0
ReturnToService=2
NodeName={host} NodeAddr=127.0.0.1 CPUs=2
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"
    )
}

fn free_ports() -> [u16; 2] {
    let listeners = [(); 2].map(|()| TcpListener::bind("127.0.0.1:0").expect("a port"));
    listeners.map(|listener| listener.local_addr().expect("its address").port())
}
