//! The web socket: the state ten times a second to each page, and the watch over whether a page is there.
//!
//! A browser answers a ping by itself, even for a page that nobody looks at; a page that does not answer
//! is gone. When the last page goes while the robot drives, the robot pauses.

use super::error::Failure;
use super::{Dashboard, lock, status};
use axum::extract::State;
use axum::extract::ws::{Message, Utf8Bytes, WebSocket, WebSocketUpgrade};
use axum::http::StatusCode;
use axum::response::Response;
use std::time::Duration;
use tokio::time::{Instant, interval};

/// What a page may say at once; it has nothing to say.
const LARGEST_MESSAGE: usize = 4096;
/// So many pages at most; each costs a little of the time that the others have.
const MOST_SOCKETS: usize = 128;
const PING_INTERVAL: Duration = Duration::from_secs(1);
/// A page that has not answered for so long is gone.
const PATIENCE: Duration = Duration::from_secs(4);

/// Opens a socket.
pub(super) async fn open(
    State(dashboard): State<Dashboard>,
    upgrade: WebSocketUpgrade,
) -> Result<Response, Failure> {
    if dashboard.status.receiver_count() >= MOST_SOCKETS {
        let status = StatusCode::SERVICE_UNAVAILABLE;
        return Err(Failure::new(status, "http.sockets", "too many pages are open", "close some"));
    }
    let upgrade = upgrade.max_message_size(LARGEST_MESSAGE).max_frame_size(LARGEST_MESSAGE);
    Ok(upgrade.on_upgrade(move |socket| follow(socket, dashboard)))
}

/// Sends the state until the page is gone.
async fn follow(mut socket: WebSocket, dashboard: Dashboard) {
    let mut states = dashboard.status.subscribe();
    let _watch = Watch(&dashboard);
    let mut heard = Instant::now();
    let mut pings = interval(PING_INTERVAL);
    let first: Utf8Bytes = status::document(&dashboard).to_string().into();
    if send(&mut socket, Message::Text(first)).await.is_err() {
        return;
    }
    while heard.elapsed() < PATIENCE {
        let message = tokio::select! {
            changed = states.changed() => match changed {
                Ok(()) => Message::Text(states.borrow_and_update().clone()),
                Err(_) => return,
            },
            _ = pings.tick() => Message::Ping(Default::default()),
            received = socket.recv() => match received {
                Some(Ok(Message::Close(_)) | Err(_)) | None => return,
                Some(Ok(_)) => {
                    heard = Instant::now();
                    continue;
                }
            },
        };
        if send(&mut socket, message).await.is_err() {
            return;
        }
    }
}

/// Sends, unless the page takes nothing any more.
async fn send(socket: &mut WebSocket, message: Message) -> Result<(), ()> {
    match tokio::time::timeout(PATIENCE, socket.send(message)).await {
        Ok(Ok(())) => Ok(()),
        _ => Err(()),
    }
}

/// A page that is open; pauses the robot when the last one goes.
struct Watch<'a>(&'a Dashboard);

impl Drop for Watch<'_> {
    fn drop(&mut self) {
        let Dashboard { controls, live, status, .. } = self.0;
        // The receiver of this page is still there.
        let is_last = status.receiver_count() <= 1;
        if is_last && lock(live).run.active && !controls.is_unattended() {
            controls.set_paused(true);
        }
    }
}
