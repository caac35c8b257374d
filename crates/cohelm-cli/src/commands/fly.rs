//! `cohelm fly`: the page, the co-pilot and the database, from one program.

use crate::numbers::whole;
use crate::output::say;
use crate::{live, rig};
use anyhow::Result;
use clap::Args;
use cohelm::registry::{Plants, Task};
use cohelm_external::{Address, TimeOut};
use cohelm_server::external::Elsewhere;
use cohelm_server::hosts::Hosts;
use cohelm_server::page::Assets;
use cohelm_server::store::SqliteStore;
use cohelm_server::{Parts, Server, bind, serve};
use serde_json::Value;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

/// The plant that values learn on while people fly, and that is flown where only options are given.
const LEARNT: &str = "flag-lander";

/// Serves the page in which a person flies with the co-pilot. Every flight is stored and can be watched again.
#[derive(Args)]
pub struct Fly {
    /// Port on this machine; 0 for any free one.
    #[arg(long, default_value_t = 8080, value_parser = whole::<u16>)]
    port: u16,
    /// The plant that the page begins with; another can be chosen there.
    #[arg(long, value_name = "PLANT", conflicts_with = "external")]
    task: Option<String>,
    /// An option of that plant, NAME=VALUE; may be given again. actions=continuous flies on axes.
    #[arg(long = "option", value_name = "NAME=VALUE", conflicts_with = "external")]
    options: Vec<String>,
    /// Where flights are stored; made if it is not there.
    #[arg(long, default_value = "cohelm.db", value_name = "FILE")]
    database: PathBuf,
    /// More models, files or folders, beside the shipped ones.
    #[arg(long = "model", value_name = "PATH")]
    models: Vec<PathBuf>,
    /// Learn while people fly (Algorithm 1, live): the values get better from flight to flight.
    #[arg(long)]
    learn: bool,
    /// Fly a plant that is elsewhere: 127.0.0.1:PORT or unix:PATH, where it listens (docs/external-plants.md).
    #[arg(long, value_name = "ADDRESS")]
    external: Option<Address>,
    /// How long the plant elsewhere may be silent before it is taken for lost, ms; 20 to 5000.
    #[arg(long, value_name = "MS", default_value = "250", requires = "external")]
    external_time_out: TimeOut,
}

impl Fly {
    /// Runs the command until Ctrl-C.
    pub fn run(self) -> Result<ExitCode> {
        start_log();
        let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
        runtime.block_on(self.serve())?;
        Ok(ExitCode::SUCCESS)
    }

    /// What the address says of the plant that was asked for; refused here if there is none such.
    fn query(&self, plants: &Plants) -> Result<String> {
        if self.task.is_none() && self.options.is_empty() {
            return Ok(String::new());
        }
        let task = rig::task(self.task.as_deref().unwrap_or(LEARNT), &self.options)?;
        plants.make(&task)?;
        Ok(query_of(&task))
    }

    async fn serve(self) -> Result<()> {
        let (plants, models) = (rig::plants(), rig::models(&self.models)?);
        let query = self.query(&plants)?;
        let listener = bind(SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), self.port)).await?;
        let store = open(&self.database).await?;
        let lessons = if self.learn {
            Some(live::lessons(&Task::new(LEARNT), &plants, &models, store.as_ref()).await?)
        } else {
            None
        };
        let parts = Parts {
            store: store.clone(),
            plants,
            models,
            lessons,
            hosts: Hosts::loopback(),
            assets: Assets::embedded(),
            study: None,
        };
        let mut server = Server::start(parts).await?;
        if let Some(address) = self.external {
            server = server.with_plant_elsewhere(Elsewhere::new(address, self.external_time_out));
        }
        let (address, database) = (listener.local_addr()?, self.database.display());
        let stop = stop_signal()?;
        say(&format!(
            "cohelm flies at http://{address}{query}\nflights are stored in {database}; Ctrl-C ends"
        ));
        serve(listener, server, stop).await?;
        store.close().await;
        Ok(())
    }
}

/// What the page reads from its address: the plant and its options, as `?task=drone&actions=continuous`.
fn query_of(task: &Task) -> String {
    let text = |value: &Value| value.as_str().map_or_else(|| value.to_string(), String::from);
    let options = task.options.as_object().into_iter().flatten();
    let options = options.map(|(name, value)| format!("&{}={}", escaped(name), escaped(&text(value))));
    format!("/?task={}{}", escaped(&task.plant), options.collect::<String>())
}

/// Everything but what an address may hold anywhere (RFC 3986, section 2.3), escaped.
fn escaped(text: &str) -> String {
    let plain = |byte: &u8| byte.is_ascii_alphanumeric() || b"-._~".contains(byte);
    let escape = |byte: u8| if plain(&byte) { char::from(byte).into() } else { format!("%{byte:02X}") };
    text.bytes().map(escape).collect()
}

/// Opens the database of flights, or makes it.
pub async fn open(database: &Path) -> Result<Arc<SqliteStore>> {
    let store = SqliteStore::open(database).await;
    Ok(Arc::new(store?))
}

/// Opens a database of flights that must be there.
pub async fn open_existing(database: &Path) -> Result<Arc<SqliteStore>> {
    Ok(Arc::new(SqliteStore::open_existing(database).await?))
}

/// Hears from now on whether somebody asks the program to end; done when somebody has. To be called before anybody is told
/// that the program is there: who then asks at once is not to find it killed with its database open.
pub fn stop_signal() -> std::io::Result<impl Future<Output = ()>> {
    #[cfg(unix)]
    {
        use tokio::signal::unix::{SignalKind, signal};
        let (mut interrupted, mut terminated) =
            (signal(SignalKind::interrupt())?, signal(SignalKind::terminate())?);
        Ok(async move {
            tokio::select! {
                _ = interrupted.recv() => {}
                _ = terminated.recv() => {}
            }
        })
    }
    #[cfg(windows)]
    {
        let mut interrupted = tokio::signal::windows::ctrl_c()?;
        Ok(async move {
            interrupted.recv().await;
        })
    }
}

/// Writes what runs long to standard error; RUST_LOG says how much (warnings unless it is set).
pub fn start_log() {
    let filter = tracing_subscriber::EnvFilter::try_from_default_env();
    let filter = filter.unwrap_or_else(|_| tracing_subscriber::EnvFilter::new("warn"));
    tracing_subscriber::fmt().with_env_filter(filter).with_writer(std::io::stderr).init();
}
