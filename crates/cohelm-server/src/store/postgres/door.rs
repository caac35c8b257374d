//! What stands before a PostgreSQL database: its address, whether it suits, and what its errors mean.

use crate::store::StoreError;
use sqlx::migrate::MigrateError;
use sqlx::postgres::{PgConnectOptions, PgDatabaseError, PgPool, PgPoolOptions, PgSslMode};
use sqlx::{ConnectOptions, Row};
use std::net::IpAddr;
use std::str::FromStr;
use std::time::Duration;

/// How long to wait for a connection, or for another program that writes: shorter fails where patience would have done.
pub const PATIENCE: Duration = Duration::from_millis(if cfg!(test) { 1_000 } else { 5_000 });
/// One connection writes, the others read meanwhile.
const CONNECTIONS: u32 = 4;

/// An address as options, and as it is shown: without the password.
pub fn options(address: &str) -> Result<(PgConnectOptions, String), StoreError> {
    let options = PgConnectOptions::from_str(address).map_err(|error| StoreError::Address {
        // Whatever it is, a password may be in it.
        database: "the address".into(),
        reason: match error {
            sqlx::Error::Configuration(wrong) => wrong.to_string(),
            other => other.to_string(),
        },
    })?;
    let name = shown(&options);
    let options = if says_how_to_encrypt(address) || stays_on_this_machine(&options) {
        options
    } else {
        // What people did in a study does not cross a network in the clear because nobody thought of it.
        options.ssl_mode(PgSslMode::VerifyFull)
    };
    let patience_ms = PATIENCE.as_millis().to_string();
    let options = options.application_name("cohelm").options([
        ("search_path", "cohelm"),
        // With less, a commit that was acknowledged may be gone after a loss of power.
        ("synchronous_commit", "on"),
        ("default_transaction_isolation", "read committed"),
        ("lock_timeout", &patience_ms),
        // A program whose machine vanished in the middle of a transaction must not keep the next one from writing.
        ("idle_in_transaction_session_timeout", "30000"),
        ("tcp_keepalives_idle", "30"),
    ]);
    Ok((options.disable_statement_logging(), name))
}

fn shown(options: &PgConnectOptions) -> String {
    let place = match options.get_socket() {
        Some(socket) => socket.display().to_string(),
        None => format!("{}:{}", options.get_host(), options.get_port()),
    };
    let user = options.get_username();
    format!("postgres://{user}@{place}/{}", options.get_database().unwrap_or(user))
}

fn says_how_to_encrypt(address: &str) -> bool {
    address.contains("sslmode=") || address.contains("ssl-mode=") || std::env::var_os("PGSSLMODE").is_some()
}

fn stays_on_this_machine(options: &PgConnectOptions) -> bool {
    let host = options.get_host();
    let loopback = host.trim_matches(['[', ']']).parse().is_ok_and(|ip: IpAddr| ip.is_loopback());
    options.get_socket().is_some() || host.starts_with('/') || host == "localhost" || loopback
}

/// Connections are made when they are needed, so that a server which comes back is found again.
pub fn pool(options: PgConnectOptions) -> PgPool {
    PgPoolOptions::new().max_connections(CONNECTIONS).acquire_timeout(PATIENCE).connect_lazy_with(options)
}

/// What is there before we change anything.
pub struct Found {
    /// Our schema.
    pub has_schema: bool,
    has_migrations: bool,
    tables: i64,
    encoding: String,
    fsync: String,
}

/// Looks without changing anything.
pub async fn look(pool: &PgPool) -> Result<Found, sqlx::Error> {
    let sql = "SELECT to_regnamespace('cohelm') IS NOT NULL, to_regclass('cohelm._sqlx_migrations') IS NOT NULL, \
        (SELECT COUNT(*) FROM pg_tables WHERE schemaname = 'cohelm'), current_setting('server_encoding'), \
        current_setting('fsync')";
    let row = sqlx::query(sql).fetch_one(pool).await?;
    Ok(Found {
        has_schema: row.try_get(0)?,
        has_migrations: row.try_get(1)?,
        tables: row.try_get(2)?,
        encoding: row.try_get(3)?,
        fsync: row.try_get(4)?,
    })
}

impl Found {
    /// True if our tables are there, false if they can be made.
    pub fn refuse_unsuitable(&self, name: &str) -> Result<bool, StoreError> {
        if self.tables > 0 && !self.has_migrations {
            return Err(StoreError::Foreign { database: format!("the schema cohelm of {name}") });
        }
        if self.encoding != "UTF8" {
            let reason = format!(
                "it holds text as {} and cannot hold every language; make it with createdb --encoding UTF8 --template \
                 template0",
                self.encoding
            );
            return Err(StoreError::Unsuitable { database: name.into(), reason });
        }
        if self.fsync != "on" {
            tracing::warn!(
                database = name,
                "the server runs with fsync = off: what it acknowledges may be gone after a loss of power"
            );
        }
        Ok(self.has_migrations)
    }
}

/// What an error of the database means.
pub fn error(name: &str, error: sqlx::Error) -> StoreError {
    let (database, reason) = (name.to_owned(), error.to_string());
    match error {
        sqlx::Error::Database(told) => match told.try_downcast_ref::<PgDatabaseError>() {
            Some(told) => told_by_server(database, told),
            None => StoreError::Other { database, reason },
        },
        sqlx::Error::Tls(_) => StoreError::NotEncrypted { database, reason },
        sqlx::Error::PoolTimedOut => {
            StoreError::Gone { database, reason: format!("no connection within {} s", PATIENCE.as_secs()) }
        }
        sqlx::Error::Io(_) | sqlx::Error::Protocol(_) | sqlx::Error::WorkerCrashed => {
            StoreError::Gone { database, reason }
        }
        _ => StoreError::Other { database, reason },
    }
}

/// By code (<https://www.postgresql.org/docs/current/errcodes-appendix.html>); its first two characters are the class.
fn told_by_server(database: String, told: &PgDatabaseError) -> StoreError {
    let reason = told.message().to_owned();
    match (told.code(), told.table()) {
        ("23505", Some("episodes")) => StoreError::KeyInUse,
        ("23505", Some("participants")) => StoreError::ParticipantExists,
        ("23503", Some("episodes")) => StoreError::ModelNotStored,
        ("22021" | "22P05", _) => StoreError::Value { what: "a text", value: reason },
        ("55P03" | "40P01", _) => StoreError::Locked { database, waited_s: PATIENCE.as_secs() },
        ("53100", _) => StoreError::Full { database },
        ("3D000", _) => StoreError::NoEntry { database, reason },
        ("42501" | "25006", _) => StoreError::Unwritable { database, reason },
        ("XX001" | "XX002" | "58P01", _) => StoreError::Damaged { database, reason },
        (code, _) => match &code[..2] {
            "08" | "53" | "57" => StoreError::Gone { database, reason },
            "28" => StoreError::NoEntry { database, reason },
            _ => StoreError::Other { database, reason },
        },
    }
}

/// What an error of a migration means.
pub fn migration_error(name: &str, known: i64, error: MigrateError) -> StoreError {
    match error {
        MigrateError::VersionMissing(found) => StoreError::Newer { database: name.into(), found, known },
        MigrateError::Execute(error) | MigrateError::ExecuteMigration(error, _) => self::error(name, error),
        other => StoreError::Other { database: name.into(), reason: other.to_string() },
    }
}
