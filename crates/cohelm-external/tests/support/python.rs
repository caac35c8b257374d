//! The example in Python as a process, for the tests of this crate and of the server.

use cohelm_external::Address;
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};

/// Killed when it is dropped.
pub struct Python {
    pub child: Child,
    pub address: Address,
}

impl Python {
    pub fn start() -> Self {
        Self::start_with(&[])
    }

    /// With further arguments.
    pub fn start_with(more: &[&str]) -> Self {
        let example = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/external-plant/plant.py");
        let mut command = Command::new("python3");
        command.args([example, "--listen", "0"]).args(more).stdout(Stdio::piped());
        let mut child =
            command.spawn().expect("this test flies the example plant and needs python3 on the PATH");
        let mut line = String::new();
        BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
        let address = line.trim().strip_prefix("the cart listens at ").expect("an address").parse().unwrap();
        Self { child, address }
    }
}

impl Drop for Python {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
