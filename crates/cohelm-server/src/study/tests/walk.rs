//! A participant goes from the link to thanks over a real listener, with flights over a real socket.

use crate::protocol::ToPage;
use crate::store::{ParticipantId, Progress, Studies};
use crate::study::testing::line::{Line, fly, listen, until_flight};
use crate::study::testing::{Browser, running};
use crate::testing::Disk;
use axum::http::StatusCode;
use serde_json::json;

#[tokio::test]
async fn a_participant_goes_from_the_link_through_consent_forms_and_flights_to_thanks() {
    let disk = Disk::new().await;
    let server = running(&disk).await;
    let address = listen(&server).await;
    let mut browser = Browser::new(&server);
    let pid = "5f3a9c0d1e2b4a6788990011";
    let joined = browser.get(&format!("/join?PROLIFIC_PID={pid}&STUDY_ID=7&lang=de")).await;
    assert_eq!(
        (joined.status, joined.headers["location"].to_str().unwrap()),
        (StatusCode::SEE_OTHER, "/study")
    );
    let session = browser.open().await;
    assert_eq!(
        (session["status"].as_str(), session["steps"].as_array().unwrap().len()),
        (Some("invited"), 1)
    );
    assert_eq!(session["study"]["title"], "Eine kleine Studie");
    let mut flown = Vec::new();
    let mut line = Line::connect(address, &browser).await.unwrap();
    assert!(matches!(line.hear().await, ToPage::Welcome(_)));
    loop {
        let session = until_flight(&mut browser).await;
        let step = session["steps"][0].clone();
        if step["kind"] == "thanks" {
            let code = step["code"].as_str().unwrap();
            let back = format!("https://panel.example/done?cc={code}&who={pid}");
            assert_eq!(
                (session["status"].as_str(), step["return_address"].as_str()),
                (Some("completed"), Some(&*back))
            );
            break;
        }
        let id = step["id"].as_str().unwrap();
        let early = browser.answer(id, json!({})).await;
        assert_eq!(early.status, StatusCode::CONFLICT, "a flight is flown before it is noted");
        flown.push((id.to_owned(), fly(&mut line, &session).await));
        let landed = browser.get("/api/session").await.json();
        assert!(landed["steps"][0]["flown"].is_string(), "{landed}");
        let noted = browser.answer(id, json!({ "late_ticks": 2 })).await;
        assert_eq!(noted.status, StatusCode::OK, "{noted:?}");
    }
    assert_eq!(flown.len(), 3);
    let trials = disk.store.trials(ParticipantId(1)).await.unwrap();
    let stored: Vec<_> =
        trials.iter().map(|row| (row.trial.as_ref().unwrap().step.clone(), row.id.0)).collect();
    assert_eq!(stored, flown);
    assert!(trials.iter().all(|row| matches!(row.progress, Progress::Finished { .. })));
    // Another server on the same database folds the same log.
    let again = Browser { cookies: browser.cookies.clone(), ..Browser::new(&running(&disk).await) }
        .get("/api/session")
        .await;
    let (mut again, mut before) = (again.json(), browser.get("/api/session").await.json());
    (again["server_ms"], before["server_ms"]) = (0.into(), 0.into());
    assert_eq!(again, before);
}
