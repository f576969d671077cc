//! The camera of `wmr sim`: its frames, as they are delivered, into a folder and to whoever asks by HTTP.
//!
//! ```text
//! simulation ─► frame ─┬─► PNG, frames.jsonl            (files)
//!                      └─► JPEG ─► /stream, /snapshot    (server)
//! ```

mod files;
mod server;

use super::args::CameraArgs;
use super::error::{CliError, Exit};
use super::output::Output;
use files::Files;
pub(super) use files::png;
use hil_sim::camera::{self, Frame, Stream, Timing};
use hil_sim::simulation::{Firmware, Simulation};
use server::Server;

/// Where the frames go.
#[derive(Debug)]
pub(super) struct Outlets {
    files: Option<Files>,
    server: Option<Server>,
}

/// The camera that `args` ask for, over a floor of this size, m, if they ask for one.
pub(super) fn stream(args: &CameraArgs, size: [f64; 2], seed: u64) -> Option<Stream> {
    let timing = Timing { rate: args.camera_rate, latency: args.camera_latency, lost: 0.0, seed };
    let camera = || camera::Camera::above(size, args.camera_size);
    args.is_used().then(|| Stream::new(camera(), timing))
}

impl Outlets {
    /// Opens what `args` ask for, and says where it is.
    pub(super) fn open(
        args: &CameraArgs,
        camera: Option<&Stream>,
        output: Output,
    ) -> Result<Self, CliError> {
        let Some(camera) = camera else { return Ok(Self { files: None, server: None }) };
        let lens = camera.camera().lens();
        let files = args.camera_out.as_deref().map(|path| Files::create(path, lens)).transpose()?;
        let server = args.camera_http.as_deref().map(|name| Server::open(name, output));
        Ok(Self { files, server: server.transpose()? })
    }

    /// Hands on all frames that have been delivered; the newest of them.
    pub(super) fn take<B: Firmware>(
        &mut self,
        simulation: &mut Simulation<B>,
    ) -> Result<Option<Frame>, CliError> {
        let mut newest = None;
        while let Some(frame) = simulation.take_frame() {
            if let Some(files) = &mut self.files {
                files.save(&frame)?;
            }
            if let Some(server) = &mut self.server {
                server.show(&frame, simulation.now())?;
            }
            newest = Some(frame);
        }
        Ok(newest)
    }
}

fn not_encoded(error: &image::ImageError) -> CliError {
    let message = format!("a frame cannot be encoded: {error}");
    CliError::new(Exit::File, "camera.frame", message, "please report this, with the command")
}
