//! Heavy work, one at a time and off the thread that answers requests: seeing and planning.

use super::error::Failure;
use axum::http::StatusCode;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::Semaphore;

/// A job that is to begin waits so long for the one before.
const PATIENCE: Duration = Duration::from_secs(3);

/// The one place where a job can be.
#[derive(Clone, Debug)]
pub(super) struct Jobs(Arc<Semaphore>);

impl Default for Jobs {
    fn default() -> Self {
        Self(Arc::new(Semaphore::new(1)))
    }
}

impl Jobs {
    /// Whether a job is under way.
    pub(super) fn is_busy(&self) -> bool {
        self.0.available_permits() == 0
    }

    /// Runs `job` as soon as no other runs. A request that is given up does not end its job, which
    /// keeps its place until it is done.
    pub(super) async fn run<T: Send + 'static>(
        &self,
        job: impl FnOnce() -> Result<T, Failure> + Send + 'static,
    ) -> Result<T, Failure> {
        let wait = tokio::time::timeout(PATIENCE, self.0.clone().acquire_owned());
        let Ok(Ok(place)) = wait.await else {
            let help = "wait until it is done, then try again";
            let status = StatusCode::TOO_MANY_REQUESTS;
            return Err(Failure::new(
                status,
                "http.busy",
                "another photo or plan is being worked on",
                help,
            ));
        };
        let result = tokio::task::spawn_blocking(move || {
            let result = job();
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
            let failed = jobs.run(|| -> Result<(), Failure> { panic!("a broken job") }).await;
            assert_eq!(failed.unwrap_err().error.code, "bug");
            assert!(!jobs.is_busy());
            assert_eq!(jobs.run(|| Ok(1)).await.unwrap(), 1);
        });
    }
}
