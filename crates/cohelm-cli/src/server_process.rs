//! This program once more as a server of its own, so that it can be measured, or killed, like any other process.

use anyhow::{Context, Result, bail};
use std::ffi::OsStr;
use std::io::{BufRead, BufReader};
use std::net::SocketAddr;
use std::process::{Child, Command, Stdio};

/// Clock ticks of /proc a second: Linux shows 100 to programs, whatever the kernel counts in.
const CLOCK_TICKS_PER_S: f64 = 100.0;

/// A running server; killed when it is dropped.
pub struct ServerProcess {
    child: Child,
    /// Where it listens.
    pub address: SocketAddr,
}

/// What a process has used so far.
#[derive(Clone, Copy, Debug)]
pub struct Usage {
    /// Memory now, KiB.
    pub memory_kib: f64,
    /// The most memory until now, KiB.
    pub peak_kib: f64,
    /// Time on processors, seconds.
    pub cpu_s: f64,
}

impl ServerProcess {
    /// Starts the program with these arguments and waits until it prints an address.
    pub fn start<Argument: AsRef<OsStr>>(arguments: impl IntoIterator<Item = Argument>) -> Result<Self> {
        let program = std::env::current_exe().context("this program cannot be found")?;
        let mut child = Command::new(&program)
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .with_context(|| format!("cannot start {}", program.display()))?;
        let output = child.stdout.take().context("the server has no output")?;
        let mut lines = BufReader::new(output).lines();
        while let Some(line) = lines.next().transpose()? {
            if let Some(address) = address_in(&line) {
                // Whoever prints to a pipe that nobody reads ends up waiting.
                std::thread::spawn(move || lines.for_each(drop));
                return Ok(Self { child, address });
            }
        }
        let status = child.wait()?;
        bail!("the server did not start ({status})")
    }

    /// What it has used so far; `None` where there is no /proc.
    pub fn usage(&self) -> Option<Usage> {
        usage(&self.child.id().to_string())
    }

    /// Kills it at once, as a crash would, and waits until it is gone.
    pub fn kill(&mut self) {
        // Both fail only if it is gone already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Drop for ServerProcess {
    fn drop(&mut self) {
        self.kill();
    }
}

/// What this process has used so far; `None` where there is no /proc.
pub fn own_usage() -> Option<Usage> {
    usage("self")
}

fn usage(process: &str) -> Option<Usage> {
    let read = |file| std::fs::read_to_string(format!("/proc/{process}/{file}")).ok();
    let (status, stat) = (read("status")?, read("stat")?);
    // The program's name stands in parentheses and may hold anything; user and system time follow as numbers 12 and 13.
    let mut times = stat.rsplit_once(") ")?.1.split(' ').skip(11).map(|ticks| ticks.parse::<f64>().ok());
    let cpu_s = (times.next()?? + times.next()??) / CLOCK_TICKS_PER_S;
    Some(Usage { memory_kib: kib(&status, "VmRSS:")?, peak_kib: kib(&status, "VmHWM:")?, cpu_s })
}

fn kib(status: &str, name: &str) -> Option<f64> {
    let line = status.lines().find_map(|line| line.strip_prefix(name))?;
    line.split_whitespace().next()?.parse().ok()
}

/// The address that a line names with a link.
fn address_in(line: &str) -> Option<SocketAddr> {
    let (_, link) = line.split_once("://")?;
    link.split(['/', ' ', '\t']).next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_is_found_in_what_a_server_prints() {
        let known = Some("127.0.0.1:41".parse().unwrap());
        assert_eq!(address_in("cohelm flies at http://127.0.0.1:41"), known);
        assert_eq!(address_in("participants: http://127.0.0.1:41/join (open)"), known);
        assert_eq!(address_in("flights are stored in cohelm.db"), None);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_process_knows_what_it_uses() {
        let used = own_usage().unwrap();
        assert!(used.memory_kib > 100.0 && used.peak_kib >= used.memory_kib && used.cpu_s >= 0.0, "{used:?}");
    }
}
