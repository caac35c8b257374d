//! How much is taken in, and how often.

use crate::limits::{OF_A_PARTICIPANT, OF_LOGINS};
use crate::study::testing::{Browser, running};
use crate::testing::Disk;
use axum::http::StatusCode;
use serde_json::json;

#[tokio::test]
async fn a_participant_who_asks_too_often_waits_and_the_others_do_not() {
    let disk = Disk::new().await;
    let server = running(&disk).await;
    let (mut hasty, mut calm) = (Browser::participant(&server).await, Browser::participant(&server).await);
    let mut last = StatusCode::OK;
    for _ in 0..20 * OF_A_PARTICIPANT.burst as usize {
        let answer = hasty.get("/api/session").await;
        last = answer.status;
        if last == StatusCode::TOO_MANY_REQUESTS {
            assert!(answer.headers.contains_key("retry-after") && answer.error().contains("wait"));
            break;
        }
    }
    assert_eq!(last, StatusCode::TOO_MANY_REQUESTS);
    assert_eq!(calm.get("/api/session").await.status, StatusCode::OK);
}

#[tokio::test]
async fn links_and_secrets_are_not_tried_without_end() {
    let disk = Disk::new().await;
    let server = running(&disk).await;
    let mut browser = Browser::new(&server);
    let study = server.study().unwrap().clone();
    let guess = format!("/p/{}", "0".repeat(32));
    assert_eq!(browser.get(&guess).await.status, StatusCode::NOT_FOUND);
    while study.let_in().is_ok() {}
    assert_eq!(browser.get(&guess).await.status, StatusCode::TOO_MANY_REQUESTS);
    while study.let_join().is_ok() {}
    assert_eq!(browser.get("/join").await.status, StatusCode::TOO_MANY_REQUESTS);
    let mut tried = 0;
    while browser.post("/api/desk/login", json!({ "secret": "password" })).await.status
        == StatusCode::UNAUTHORIZED
    {
        tried += 1;
        assert!(tried <= 2 * OF_LOGINS.burst as usize, "never too many");
    }
    assert!(browser.cookies.is_empty());
}

#[tokio::test]
async fn what_is_too_large_or_of_the_wrong_shape_is_refused() {
    let disk = Disk::new().await;
    let server = running(&disk).await;
    let mut browser = Browser::participant(&server).await;
    let large = json!({ "tab": "tab-1", "data": "x".repeat(70_000) });
    assert_eq!(browser.post("/api/session/steps/consent", large).await.status, StatusCode::PAYLOAD_TOO_LARGE);
    for (body, expected) in [
        (json!({ "tab": "t".repeat(65), "client": {} }), StatusCode::UNPROCESSABLE_ENTITY),
        (json!({ "tab": "", "client": {} }), StatusCode::UNPROCESSABLE_ENTITY),
        (json!({ "tab": "t", "client": "x".repeat(5_000) }), StatusCode::UNPROCESSABLE_ENTITY),
        (json!({ "tab": "t", "colour": "red" }), StatusCode::UNPROCESSABLE_ENTITY),
        (json!([1, 2]), StatusCode::UNPROCESSABLE_ENTITY),
    ] {
        let answer = browser.post("/api/session/open", body.clone()).await;
        assert_eq!(answer.status, expected, "{body}");
    }
    assert_eq!(browser.get("/api/session").await.status, StatusCode::OK);
}
