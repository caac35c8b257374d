//! The researcher's part of a dry run: lets simulated participants in.

use super::http::Http;
use super::{VisitError, path_of};
use serde_json::json;
use std::net::SocketAddr;

/// A researcher who has shown the secret.
pub struct Desk {
    http: Http,
}

impl Desk {
    /// Logs in.
    pub async fn open(address: SocketAddr, secret: &str) -> Result<Self, VisitError> {
        let mut http = Http::new(address);
        http.post("/api/desk/login", &json!({ "secret": secret })).await?.expect("logging in")?;
        Ok(Self { http })
    }

    /// Makes a participant that everything will call simulated; gives the path of its link.
    pub async fn invite_simulated(&mut self) -> Result<String, VisitError> {
        let asked = json!({ "simulated": true });
        let made = self.http.post("/api/desk/participants", &asked).await?.expect("inviting")?;
        let link = made["link"].as_str().unwrap_or_default();
        path_of(link).ok_or_else(|| VisitError::Unclear(format!("{link:?} is no link")))
    }
}
