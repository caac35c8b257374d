//! The server is lost, and found again.

use super::*;
use std::net::SocketAddr;
use tokio::net::{TcpListener, TcpStream};
use tokio::task::JoinHandle;

/// A wire to the server that can be cut.
struct Wire {
    address: SocketAddr,
    carrying: JoinHandle<()>,
}

impl Wire {
    async fn at(address: &str, server: SocketAddr) -> Self {
        let listener = TcpListener::bind(address).await.unwrap();
        let address = listener.local_addr().unwrap();
        Self { address, carrying: tokio::spawn(carry(listener, server)) }
    }

    /// Nothing passes any more, and nobody listens.
    async fn cut(self) -> SocketAddr {
        self.carrying.abort();
        // Wait until it has let go of its sockets.
        let _ = self.carrying.await;
        self.address
    }
}

/// Dropping this drops every connection.
async fn carry(listener: TcpListener, server: SocketAddr) {
    let mut connections = tokio::task::JoinSet::new();
    loop {
        let (mut near, _) = listener.accept().await.unwrap();
        connections.spawn(async move {
            let mut far = TcpStream::connect(server).await?;
            tokio::io::copy_bidirectional(&mut near, &mut far).await
        });
    }
}

#[tokio::test]
#[ignore = "needs a server"]
async fn a_server_that_goes_is_said_so_and_found_again_when_it_comes_back() {
    let database = EmptyDatabase::new().await;
    let (place, _) = database.address.rsplit_once('/').unwrap();
    let server: SocketAddr = place.rsplit_once('@').unwrap().1.parse().unwrap();
    let wire = Wire::at("127.0.0.1:0", server).await;
    let address = database.address.replace(&server.to_string(), &wire.address.to_string());
    let store = PostgresStore::open(&address).await.unwrap();
    store.commit(&[episode()]).await.unwrap();
    let under_way = store.driver.begin().await.unwrap();

    let listened_at = wire.cut().await;
    let lost = under_way.commit().await.unwrap_err();
    assert!(matches!(lost, StoreError::Gone { .. }), "{lost:?}");
    for _ in 0..2 {
        let error = store.commit(&[episode()]).await.unwrap_err();
        assert!(matches!(error, StoreError::Gone { .. }) && !error.is_about_one_write(), "{error:?}");
        let error = store.check().await.unwrap_err();
        assert!(error.to_string().contains("does not answer"), "{error}");
    }

    let _wire = Wire::at(&listened_at.to_string(), server).await;
    store.commit(&[episode()]).await.unwrap();
    assert_eq!(store.episodes(Page::newest(9)).await.unwrap().len(), 2);
    store.close().await;
    database.remove().await;
}

#[tokio::test]
#[ignore = "needs a server"]
async fn connections_that_the_server_ended_are_made_anew() {
    let database = EmptyDatabase::new().await;
    database.store.commit(&[episode()]).await.unwrap();
    let end_all = "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE pid <> pg_backend_pid()";
    let end_all = format!("{end_all} AND datname = '{}'", database.name);
    execute(&database.server, &end_all).await;
    database.store.commit(&[episode()]).await.unwrap();
    assert_eq!(database.store.episodes(Page::newest(9)).await.unwrap().len(), 2);
    database.remove().await;
}
