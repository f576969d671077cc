//! Heavy work, one at a time and off the thread that answers requests: seeing and planning.

use super::error::Failure;
use axum::http::StatusCode;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{Semaphore, watch};

/// A job that is to begin waits so long for the one before.
const PATIENCE: Duration = Duration::from_secs(3);

/// The one place where a job can be, and how often somebody has given one up.
#[derive(Clone, Debug)]
pub(super) struct Jobs {
    place: Arc<Semaphore>,
    cancels: watch::Sender<u64>,
}

impl Default for Jobs {
    fn default() -> Self {
        Self { place: Arc::new(Semaphore::new(1)), cancels: watch::Sender::default() }
    }
}

/// What a job asks between its steps.
#[derive(Debug)]
pub(super) struct Going(watch::Receiver<u64>);

impl Going {
    /// An error if the job was given up since it was asked for.
    pub(super) fn check(&self) -> Result<(), Failure> {
        if self.0.has_changed().unwrap_or(true) { Err(cancelled()) } else { Ok(()) }
    }
}

impl Jobs {
    /// Whether a job is under way.
    pub(super) fn is_busy(&self) -> bool {
        self.place.available_permits() == 0
    }

    /// Gives up the job under way and those that wait: who asked for them is told so at once.
    pub(super) fn cancel(&self) {
        self.cancels.send_modify(|count| *count = count.wrapping_add(1));
    }

    /// Runs `job` as soon as no other runs. One that is given up, or whose request is, keeps its place until
    /// its next step.
    pub(super) async fn run<T: Send + 'static>(
        &self,
        job: impl FnOnce(&Going) -> Result<T, Failure> + Send + 'static,
    ) -> Result<T, Failure> {
        let mut cancels = self.cancels.subscribe();
        let going = Going(self.cancels.subscribe());
        tokio::select! {
            result = self.run_in_turn(going, job) => result,
            _ = cancels.changed() => Err(cancelled()),
        }
    }

    async fn run_in_turn<T: Send + 'static>(
        &self,
        going: Going,
        job: impl FnOnce(&Going) -> Result<T, Failure> + Send + 'static,
    ) -> Result<T, Failure> {
        let wait = tokio::time::timeout(PATIENCE, self.place.clone().acquire_owned());
        let Ok(Ok(place)) = wait.await else {
            let help = "wait until it is done, or cancel it, then try again";
            let status = StatusCode::TOO_MANY_REQUESTS;
            return Err(Failure::new(
                status,
                "http.busy",
                "another photo or plan is being worked on",
                help,
            ));
        };
        let result = tokio::task::spawn_blocking(move || {
            let result = going.check().and_then(|()| job(&going));
            drop(place);
            result
        });
        result.await.unwrap_or_else(|_| {
            let status = StatusCode::INTERNAL_SERVER_ERROR;
            Err(Failure::new(
                status,
                "bug",
                "this could not be worked on; it is a bug of wmr",
                "please report it, with the photo or scene",
            ))
        })
    }
}

fn cancelled() -> Failure {
    Failure::missing("http.cancelled", "this was given up", "ask again for what is wanted")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block_on<T>(future: impl Future<Output = T>) -> T {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_time().build();
        runtime.unwrap().block_on(future)
    }

    #[test]
    fn a_job_that_panics_gives_its_place_back() {
        block_on(async {
            let jobs = Jobs::default();
            let failed = jobs.run(|_| -> Result<(), Failure> { panic!("a broken job") }).await;
            assert_eq!(failed.unwrap_err().error.code, "bug");
            assert!(!jobs.is_busy());
            assert_eq!(jobs.run(|_| Ok(1)).await.unwrap(), 1);
        });
    }

    #[test]
    fn a_job_that_is_given_up_ends_at_its_next_step_and_its_request_at_once() {
        block_on(async {
            let jobs = Jobs::default();
            let (step, steps) = std::sync::mpsc::channel::<()>();
            let (said, ended) = std::sync::mpsc::channel();
            let (begin, began) = std::sync::mpsc::channel();
            let job = jobs.run(move |going: &Going| {
                let before = going.check().is_ok();
                begin.send(()).unwrap();
                steps.recv().unwrap();
                said.send((before, going.check().map_err(|failure| failure.error.code))).unwrap();
                Ok(())
            });
            let waiting = jobs.run(|_| Ok(()));
            let cancel = async {
                while began.try_recv().is_err() {
                    tokio::task::yield_now().await;
                }
                jobs.cancel();
            };
            let (job, waiting, ()) = tokio::join!(job, waiting, cancel);
            for given_up in [job, waiting] {
                assert_eq!(given_up.unwrap_err().error.code, "http.cancelled");
            }
            assert!(jobs.is_busy(), "its step is not done");
            step.send(()).unwrap();
            assert_eq!(ended.recv().unwrap(), (true, Err("http.cancelled".into())));
            // What is asked for afterwards is not given up.
            assert_eq!(jobs.run(|_| Ok(2)).await.unwrap(), 2);
        });
    }
}
