//! `cohelm study run`: the participants' pages and the researcher's, from one program.

use super::neighbours::{Running, other_versions};
use super::shelf::Shelf;
use crate::commands::fly::{start_log, stop_signal};
use crate::live;
use crate::numbers::whole;
use crate::output::say;
use anyhow::{Context, Result, bail};
use clap::Args;
use cohelm_server::hosts::Hosts;
use cohelm_server::learn::Lessons;
use cohelm_server::page::Assets;
use cohelm_server::secret::{SecretHash, Token};
use cohelm_server::store::{Store, open};
use cohelm_server::tls::Tls;
use cohelm_server::{Parts, Server, StudyRun, bind, serve, serve_tls};
use cohelm_study::design::Design;
use std::ffi::OsString;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Serves a study until Ctrl-C. Participants go on where they were after any interruption, of theirs or of this program.
#[derive(Args)]
pub struct Run {
    /// The study's file.
    file: PathBuf,
    /// Where everything is stored: a file, made if it is not there, or postgres://…; the study's name and .db unless given.
    #[arg(long, value_name = "FILE|URL")]
    database: Option<OsString>,
    /// Port; 0 for any free one.
    #[arg(long, default_value_t = 8080, value_parser = whole::<u16>)]
    port: u16,
    /// Address to listen on: this machine only unless another is given, such as 0.0.0.0.
    #[arg(long, default_value_t = IpAddr::V4(Ipv4Addr::LOCALHOST), value_name = "ADDRESS")]
    bind: IpAddr,
    /// A file with the researcher's secret; a fresh one is drawn and printed unless given.
    #[arg(long, value_name = "FILE")]
    secret_file: Option<PathBuf>,
    /// Certificate chain (PEM), to serve https.
    #[arg(long, value_name = "FILE", requires = "tls_key")]
    tls_cert: Option<PathBuf>,
    /// Its key (PEM).
    #[arg(long, value_name = "FILE", requires = "tls_cert")]
    tls_key: Option<PathBuf>,
    /// A name under which the server may be asked for, besides those of this machine; may be given again.
    #[arg(long = "host", value_name = "NAME")]
    hosts: Vec<String>,
    /// Where participants reach the server, such as https://study.example.org; for links, and behind a proxy.
    #[arg(long, value_name = "URL")]
    address: Option<String>,
    /// More models, files or folders, beside the shipped ones.
    #[arg(long = "model", value_name = "PATH")]
    models: Vec<PathBuf>,
}

/// The researcher's secret, and whether it is to be printed.
struct Secret {
    text: String,
    fresh: bool,
}

impl Run {
    /// Runs the command until Ctrl-C.
    pub fn run(self) -> Result<ExitCode> {
        start_log();
        let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
        runtime.block_on(self.serve())?;
        Ok(ExitCode::SUCCESS)
    }

    async fn serve(self) -> Result<()> {
        let shelf = Shelf::new(&self.models)?;
        let (design, _) = shelf.design(&self.file)?;
        let (secret, tls, address_given) = (self.secret()?, self.tls()?, self.address()?);
        let listener = bind(SocketAddr::new(self.bind, self.port)).await?;
        let address = match address_given {
            Some(address) => address,
            None => self.own_address(listener.local_addr()?),
        };
        let database = self.database.clone().unwrap_or_else(|| format!("{}.db", design.name).into());
        let store = open(&database).await?;
        let running = Running::mark(&database);
        let notes = [other_versions(store.as_ref(), &design).await?, running.as_ref().err().cloned()];
        let study = StudyRun {
            design: design.clone(),
            secret: SecretHash::of(&secret.text)?,
            address: address.clone(),
        };
        let parts = Parts {
            store: store.clone(),
            lessons: lessons(&design, &shelf, store.as_ref()).await?,
            plants: shelf.plants,
            models: shelf.models,
            hosts: self.hosts(&address),
            assets: Assets::embedded(),
            study: Some(study),
        };
        let server = Server::start(parts).await?;
        let stop = stop_signal()?;
        say(&greeting(&design, &address, &secret, &shown(&database)));
        for note in notes.into_iter().flatten() {
            say(&format!("note           {note}"));
        }
        match tls {
            Some(tls) => serve_tls(listener, tls, server, stop).await?,
            None => serve(listener, server, stop).await?,
        }
        store.close().await;
        Ok(())
    }

    fn secret(&self) -> Result<Secret> {
        let Some(file) = &self.secret_file else {
            return Ok(Secret { text: Token::draw()?.text().to_owned(), fresh: true });
        };
        let text = std::fs::read_to_string(file)
            .with_context(|| format!("cannot read the secret in {}", file.display()))?;
        Ok(Secret { text: text.trim_end_matches(['\r', '\n']).to_owned(), fresh: false })
    }

    fn tls(&self) -> Result<Option<Tls>> {
        let Some((certificate, key)) = self.tls_cert.as_ref().zip(self.tls_key.as_ref()) else {
            return Ok(None);
        };
        Ok(Some(Tls::open(certificate, key)?))
    }

    /// The address that was given, without a slash at the end.
    fn address(&self) -> Result<Option<String>> {
        let Some(address) = &self.address else { return Ok(None) };
        if !(address.starts_with("http://") || address.starts_with("https://")) {
            bail!("--address is written as in a browser, such as https://study.example.org, got {address:?}");
        }
        Ok(Some(address.trim_end_matches('/').to_owned()))
    }

    fn own_address(&self, listening: SocketAddr) -> String {
        let scheme = if self.tls_cert.is_some() { "https" } else { "http" };
        match self.hosts.first() {
            Some(host) => format!("{scheme}://{host}:{}", listening.port()),
            None => format!("{scheme}://{listening}"),
        }
    }

    /// The names that were given, that of the address, and the address listened on.
    fn hosts(&self, address: &str) -> Hosts {
        let named = address.split("://").nth(1).and_then(|rest| rest.split('/').next()).unwrap_or_default();
        let name = match named.rsplit_once(':') {
            Some((name, port)) if port.bytes().all(|byte| byte.is_ascii_digit()) => name,
            _ => named,
        };
        let more = self.hosts.iter().map(String::as_str).chain([name]).filter(|name| !name.is_empty());
        let hosts = more.fold(Hosts::loopback(), Hosts::and);
        if self.bind.is_unspecified() { hosts } else { hosts.and(&self.bind.to_string()) }
    }
}

/// What learns, if a condition of the design does.
pub async fn lessons(design: &Design, shelf: &Shelf, store: &dyn Store) -> Result<Option<Lessons>> {
    if !design.conditions.iter().any(|condition| condition.learning) {
        return Ok(None);
    }
    Ok(Some(live::lessons(&design.task.task, &shelf.plants, &shelf.models, store).await?))
}

fn greeting(design: &Design, address: &str, secret: &Secret, database: &str) -> String {
    let title = design.title.read(design.first_language(), design.first_language());
    let participants = if design.has_open_link() {
        format!("{address}/join")
    } else {
        "each has a link of their own; make them on the researcher's page".into()
    };
    let known = if secret.fresh { secret.text.as_str() } else { "the one in the file" };
    let lines = [
        format!("cohelm runs the study {:?} ({}) at {address}", title, design.name),
        format!("participants   {participants}"),
        format!("researcher     {address}/desk"),
        format!("secret         {known}"),
        format!("stored in      {database}; Ctrl-C ends"),
    ];
    lines.join("\n")
}

/// A database as it may be shown: without a password.
pub fn shown(database: &OsString) -> String {
    let text = Path::new(database).display().to_string();
    match text.split_once("://").and_then(|(scheme, rest)| Some((scheme, rest.rsplit_once('@')?))) {
        Some((scheme, (who, place))) => {
            format!("{scheme}://{}@{place}", who.split(':').next().unwrap_or_default())
        }
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::shown;

    #[test]
    fn no_password_is_shown() {
        for (database, expected) in [
            ("study.db", "study.db"),
            ("postgres://lab:geheim@db.example.org/study", "postgres://lab@db.example.org/study"),
            ("postgres://lab@localhost/study", "postgres://lab@localhost/study"),
            ("postgres://localhost/study", "postgres://localhost/study"),
        ] {
            assert_eq!(shown(&database.into()), expected);
        }
    }
}
