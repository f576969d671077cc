//! `wmr params`: a robot's numbers, shown or changed.

use super::args::ParamsArgs;
use super::endpoint::Endpoint;
use super::error::{CliError, Exit};
use super::output::Output;
use super::{mission, quantity};
use protocol::parameters::{FIELDS, Parameters};
use std::path::Path;
use wmr::document::{ParametersDocument, shortest};
use wmr::link::drive::wait_for;
use wmr::link::parameters::{Answer, Exchange, Request};
use wmr::link::{self, LinkClient};

/// A number to change: its place in [`FIELDS`], and what it becomes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Change {
    place: usize,
    value: f32,
}

/// A change from `name=value`; lengths may have a suffix.
pub(crate) fn change(text: &str) -> Result<Change, String> {
    let (name, value) =
        text.split_once('=').ok_or_else(|| format!("{text:?}: write NAME=VALUE"))?;
    let place = place(name)?;
    let value = if FIELDS[place].unit == "m" {
        quantity::length(value)? as f32
    } else {
        value.trim().parse().map_err(|_| format!("{value:?} is no number"))?
    };
    checked(place, value)
}

/// A change of the number called `name`.
pub(crate) fn named_change(name: &str, value: f32) -> Result<Change, String> {
    checked(place(name)?, value)
}

/// `parameters` with these changes.
pub(crate) fn changed(parameters: Parameters, changes: &[Change]) -> Parameters {
    let mut values = parameters.values();
    for Change { place, value } in changes {
        values[*place] = *value;
    }
    parameters.with_values(values)
}

fn place(name: &str) -> Result<usize, String> {
    let names = || FIELDS.each_ref().map(|field| field.name).join(", ");
    let found = FIELDS.iter().position(|field| field.name == name.trim());
    found.ok_or_else(|| format!("there is no {name:?}; there are {}", names()))
}

/// Encoder counts are whole; the other numbers are the robot's to judge.
fn checked(place: usize, value: f32) -> Result<Change, String> {
    if FIELDS[place].name == "counts-per-turn" && value.fract() != 0.0 {
        return Err(format!("{value}: a wheel has a whole number of counts in a turn"));
    }
    // The wire's integer would hold another number than was typed.
    if FIELDS[place].name == "counts-per-turn" && value > FIELDS[place].most {
        return Err(format!("{value}: at most {} counts in a turn", FIELDS[place].most));
    }
    Ok(Change { place, value })
}

/// `wmr params`.
pub(crate) fn run(args: &ParamsArgs, output: Output) -> Result<(), CliError> {
    let loaded = args.from.as_deref().map(load).transpose()?;
    let changes = loaded.is_some() || args.defaults || !args.changes.is_empty();
    mission::with_robot(&args.port, |client| {
        mission::connect(client)?;
        let mut parameters = read(client)?;
        if changes {
            parameters = change_all(client, args, parameters, loaded)?;
        }
        output.result(&document(&parameters, changes && !args.no_save), &table(&parameters))
    })
}

/// Makes the changes that `args` and the `loaded` file ask for; the robot's numbers then.
fn change_all(
    client: &mut LinkClient<Box<dyn Endpoint>>,
    args: &ParamsArgs,
    parameters: Parameters,
    loaded: Option<(Vec<Change>, u32)>,
) -> Result<Parameters, CliError> {
    let first = if args.defaults { Parameters::default() } else { parameters };
    let (from, calibration) = loaded.unwrap_or((Vec::new(), first.calibration));
    let mut values = first.values();
    for Change { place, value } in from.iter().chain(&args.changes) {
        values[*place] = *value;
    }
    let wanted = Parameters { calibration, ..first.with_values(values) };
    let parameters = set(client, wanted)?;
    if !args.no_save {
        keep(client)?;
    }
    Ok(parameters)
}

/// The robot's numbers.
pub(crate) fn read(client: &mut LinkClient<Box<dyn Endpoint>>) -> Result<Parameters, CliError> {
    parameters_of(ask(client, Request::Read)?)
}

/// Changes the robot's numbers until it loses power; what they are then.
pub(crate) fn set(
    client: &mut LinkClient<Box<dyn Endpoint>>,
    parameters: Parameters,
) -> Result<Parameters, CliError> {
    parameters_of(ask(client, Request::Change(parameters))?)
}

/// Gives the robot its `old` numbers back after something went wrong, also when a stop is wanted: it rests first.
pub(crate) fn restore(client: &mut LinkClient<Box<dyn Endpoint>>, old: Parameters) {
    if mission::stop_wanted() {
        // One that does not say that it rests refuses the numbers.
        let _ = link::drive::stop(client, || false);
    }
    let mut exchange = Exchange::new(Request::Change(old));
    // What went wrong before is what the person is told.
    let _ = wait_for(client, || false, |client, now| exchange.step(client, now));
}

/// Has the robot keep its numbers.
pub(crate) fn keep(client: &mut LinkClient<Box<dyn Endpoint>>) -> Result<(), CliError> {
    ask(client, Request::Keep).map(|_| ())
}

fn parameters_of(answer: Answer) -> Result<Parameters, CliError> {
    match answer {
        Answer::Parameters(parameters) => Ok(parameters),
        Answer::Kept | Answer::Identity(_) | Answer::Turned(_) | Answer::Measured(_) => {
            Err(CliError::new(Exit::Bug, "bug", "an answer to no question", "report it"))
        }
    }
}

/// One question and its answer.
pub(crate) fn ask(
    client: &mut LinkClient<Box<dyn Endpoint>>,
    request: Request,
) -> Result<Answer, CliError> {
    let mut exchange = Exchange::new(request);
    let answer = wait_for(client, mission::stop_wanted, |client, now| exchange.step(client, now))?;
    answer.ok_or_else(|| mission::interrupted_error("nothing has moved"))
}

/// The numbers of a file that `wmr params --json` wrote, and their calibration.
fn load(path: &Path) -> Result<(Vec<Change>, u32), CliError> {
    let bad = |why: String| {
        let message = format!("{}: {why}", path.display());
        CliError::new(
            Exit::File,
            "params.file",
            message,
            "write one with: wmr params --json > FILE",
        )
    };
    let text = std::fs::read_to_string(path).map_err(|error| bad(error.to_string()))?;
    let file: ParametersDocument =
        serde_json::from_str(&text).map_err(|error| bad(error.to_string()))?;
    let change = |(name, value): (&String, &f64)| checked(place(name)?, *value as f32);
    let changes = file.parameters.iter().map(change).collect::<Result<_, _>>().map_err(bad)?;
    Ok((changes, file.calibration))
}

/// The document of `wmr params --json`.
fn document(parameters: &Parameters, saved: bool) -> ParametersDocument {
    let numbers = FIELDS.iter().zip(parameters.values());
    ParametersDocument {
        parameters: numbers.map(|(field, value)| (field.name.into(), shortest(value))).collect(),
        calibration: parameters.calibration,
        saved,
    }
}

fn table(parameters: &Parameters) -> String {
    let row = |(field, value): (&protocol::parameters::Field, f32)| {
        let range = format!("{} to {}", field.least, field.most);
        format!("{:16} {:>9} {:7} {range}\n", field.name, value.to_string(), field.unit)
    };
    let rows: String = FIELDS.iter().zip(parameters.values()).map(row).collect();
    let calibration = match parameters.calibration {
        0 => "never calibrated; wmr calibrate base".to_owned(),
        number => format!("calibration {number}"),
    };
    format!("{rows}{calibration}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_a_name_and_a_number_that_it_may_have() {
        assert_eq!(change("track=121mm"), Ok(Change { place: 2, value: 0.121 }));
        assert_eq!(change("speed=0.3"), Ok(Change { place: 4, value: 0.3 }));
        assert!(change("counts-per-turn=1440.5").is_err());
        assert!(change("counts-per-turn=1e30").is_err());
        assert!(change("tracks=1").unwrap_err().contains("wheel-radius"));
        assert!(change("track").is_err() && change("speed=fast").is_err());
    }

    #[test]
    fn numbers_are_printed_as_they_were_typed() {
        assert_eq!(serde_json::json!(shortest(0.035)).to_string(), "0.035");
        assert_eq!(serde_json::json!(shortest(1440.0)).to_string(), "1440.0");
    }
}
