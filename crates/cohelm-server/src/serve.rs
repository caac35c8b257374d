//! A listener and its end.

use crate::app::app;
use crate::server::Server;
use crate::tls::Tls;
use axum::serve::ListenerExt;
use std::future::Future;
use std::io;
use std::net::SocketAddr;
use tokio::net::TcpListener;

/// Why no listener could be had.
#[derive(Debug, thiserror::Error)]
pub enum BindError {
    /// Somebody else listens there.
    #[error(
        "port {port} is in use, perhaps by another cohelm; choose another with --port, or --port 0 for any free one"
    )]
    InUse {
        /// Which port.
        port: u16,
    },
    /// Anything else.
    #[error("cannot listen on {address}: {source}")]
    Other {
        /// Where.
        address: SocketAddr,
        /// What the system says.
        source: io::Error,
    },
}

/// Listens; port 0 takes any free one.
pub async fn bind(address: SocketAddr) -> Result<TcpListener, BindError> {
    TcpListener::bind(address).await.map_err(|source| match source.kind() {
        io::ErrorKind::AddrInUse => BindError::InUse { port: address.port() },
        _ => BindError::Other { address, source },
    })
}

/// Serves until `shutdown` is done; then closes all connections with a reason, and returns once everything that was
/// handed in is written. An address that other machines reach is served only with a study, whose secret guards it.
pub async fn serve(
    listener: TcpListener,
    server: Server,
    shutdown: impl Future<Output = ()> + Send + 'static,
) -> io::Result<()> {
    refuse_exposure(listener.local_addr()?, &server)?;
    // Acknowledgements are small; waiting to fill a packet would delay each by up to 40 ms.
    let listener = listener.tap_io(|connection| {
        if let Err(error) = connection.set_nodelay(true) {
            tracing::debug!(%error, "TCP_NODELAY");
        }
    });
    let end = end_of(&server, shutdown);
    axum::serve(listener, app(server)).with_graceful_shutdown(end).await
}

/// The same behind TLS of the server's own.
pub async fn serve_tls(
    listener: TcpListener,
    tls: Tls,
    server: Server,
    shutdown: impl Future<Output = ()> + Send + 'static,
) -> io::Result<()> {
    refuse_exposure(listener.local_addr()?, &server)?;
    let end = end_of(&server, shutdown);
    axum::serve(tls.listen(listener)?, app(server)).with_graceful_shutdown(end).await
}

fn refuse_exposure(address: SocketAddr, server: &Server) -> io::Result<()> {
    if address.ip().is_loopback() || server.study().is_some() {
        return Ok(());
    }
    let words = format!(
        "other machines reach {address}, where anybody could read and change everything: listen on 127.0.0.1, or run \
         a study, whose researcher has a secret"
    );
    Err(io::Error::new(io::ErrorKind::PermissionDenied, words))
}

fn end_of(
    server: &Server,
    shutdown: impl Future<Output = ()> + Send + 'static,
) -> impl Future<Output = ()> + Send + 'static {
    let server = server.clone();
    async move {
        shutdown.await;
        server.stop().await;
    }
}

#[cfg(test)]
mod tests;
