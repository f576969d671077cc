//! The state as the open pages get it, ten times a second, made once for all of them.

use super::{Dashboard, lock};
use serde_json::{Value, json};
use std::time::Duration;
use tokio::time::MissedTickBehavior;

const INTERVAL: Duration = Duration::from_millis(100);

/// Keeps [`Dashboard::status`] up to date for ever.
pub(super) async fn keep(dashboard: Dashboard) {
    let mut clock = tokio::time::interval(INTERVAL);
    clock.set_missed_tick_behavior(MissedTickBehavior::Delay);
    loop {
        clock.tick().await;
        dashboard.arrange(false);
        if dashboard.status.receiver_count() > 0 {
            dashboard.status.send_replace(document(&dashboard).to_string().into());
        }
    }
}

/// What changes all the time, and the revisions of what does not.
pub(super) fn document(dashboard: &Dashboard) -> Value {
    let camera = dashboard.camera.document(&dashboard.camera_sources());
    let revisions = lock(&dashboard.desk).revisions;
    let live = lock(&dashboard.live);
    json!({
        "revision": {
            "photo": revisions.photo,
            "scene": revisions.scene,
            "plan": revisions.plan,
            "run": live.run.revision,
        },
        "busy": dashboard.jobs.is_busy(),
        "camera": camera,
        "base": live.base_document(),
        "drive": live.drive_document(dashboard.controls.is_paused()),
    })
}
