//! What the tests of visits share: a server on loopback, and a simulated person for the point.

use crate::server::Server;
use crate::{bind, serve};
use cohelm::human::{Axis, HumanPilot, Plan, Population, Seen, Skill};
use cohelm::pilot::Pilot;
use cohelm::plant::Plant;
use cohelm::point::Point;
use cohelm::random::Draws;
use std::net::SocketAddr;
use tokio::task::JoinHandle;

/// A server that runs until this is dropped.
pub struct Running {
    pub address: SocketAddr,
    serving: JoinHandle<()>,
}

impl Running {
    pub async fn new(server: Server) -> Self {
        let listener = bind("127.0.0.1:0".parse().unwrap()).await.unwrap();
        let address = listener.local_addr().unwrap();
        let serving = tokio::spawn(async {
            serve(listener, server, std::future::pending()).await.unwrap();
        });
        Self { address, serving }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.serving.abort();
    }
}

struct Steers(Plan);

impl Skill for Steers {
    fn plan(&self) -> &Plan {
        &self.0
    }

    fn errors(&self, seen: &Seen<'_>, errors: &mut [f64]) {
        for (i, error) in errors.iter_mut().enumerate() {
            let wanted_speed = (seen.goal[i] - seen.state[i]).clamp(-0.6, 0.6);
            *error = (wanted_speed - seen.state[2 + i]) / 0.05;
        }
    }
}

/// A simulated person at the keys of the point.
pub fn person(number: u64) -> Box<dyn Pilot> {
    let key =
        |name, minus| Axis { name, plus: Some(minus + 1), minus: Some(minus), release: 0.3, droppable: true };
    let plan = Plan {
        axes: vec![key("x", 0), key("y", 2)],
        moving: vec![0, 1, 2, 3],
        judged: vec![2, 3],
        shown: vec![],
    };
    let traits = Population::Ordinary.ranges().draw(&mut Draws::new(number));
    Box::new(HumanPilot::new(traits, Box::new(Steers(plan)), Point::new().space()).unwrap())
}
