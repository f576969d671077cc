//! What a person sets once for all commands: variables and two files.
//!
//! ```text
//! option of the command line ─► WMR_* variable ─► wmr.toml of the project ─► the user's file ─► default
//! ```
//! The first of them that says something counts. The project's file is the nearest `wmr.toml` from the
//! current folder upwards, or the one that `WMR_CONFIG` names; set to nothing, no file is read.

use super::error::{CliError, Exit};
use clap::error::{ContextKind, ContextValue};
use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// A setting: its option's long name, its variable, and what it is.
pub(crate) struct Setting {
    pub(crate) name: &'static str,
    pub(crate) variable: &'static str,
    is_path: bool,
}

const fn setting(name: &'static str, variable: &'static str) -> Setting {
    Setting { name, variable, is_path: false }
}

/// All settings, in the order in which they are listed.
pub(crate) const SETTINGS: [Setting; 13] = [
    setting("port", "WMR_PORT"),
    setting("arena", "WMR_ARENA"),
    Setting { is_path: true, ..setting("camera", "WMR_CAMERA") },
    setting("tags", "WMR_TAGS"),
    setting("robot-tag", "WMR_ROBOT_TAG"),
    setting("goal-tag", "WMR_GOAL_TAG"),
    setting("radius", "WMR_RADIUS"),
    setting("margin", "WMR_MARGIN"),
    setting("planner", "WMR_PLANNER"),
    setting("inflation", "WMR_INFLATION"),
    setting("timing", "WMR_TIMING"),
    setting("leg-time", "WMR_LEG_TIME"),
    setting("addr", "WMR_ADDR"),
];

const PROJECT_FILE: &str = "wmr.toml";
/// Names the project's file instead.
const FILE_VARIABLE: &str = "WMR_CONFIG";
/// No file of settings is longer, bytes.
const LONGEST_FILE: u64 = 1 << 20;

/// Which command does not take which setting: the demo is for the simulated robot, whatever is plugged in.
const EXCEPT: [(&str, &str); 1] = [("demo", "port")];

/// What one file says of one setting.
#[derive(Clone, Debug, PartialEq)]
struct Entry {
    name: &'static str,
    value: String,
    file: PathBuf,
}

/// What the files say; the first entry of a name counts.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Settings {
    entries: Vec<Entry>,
    /// The files that were read.
    pub(crate) files: Vec<PathBuf>,
}

impl Settings {
    /// Reads the project's file and the user's.
    pub(crate) fn read() -> Result<Self, CliError> {
        let mut settings = Self::default();
        for file in files() {
            let text = std::fs::metadata(&file).and_then(|data| {
                let is_short = data.len() <= LONGEST_FILE;
                if is_short {
                    std::fs::read_to_string(&file)
                } else {
                    Err(std::io::ErrorKind::FileTooLarge.into())
                }
            });
            let text = text.map_err(|error| wrong(&file, &error.to_string()))?;
            settings.entries.extend(entries(&text, &file)?);
            settings.files.push(file);
        }
        Ok(settings)
    }

    fn entry(&self, name: &str) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.name == name)
    }

    /// What is set by variable or file, and where.
    pub(crate) fn in_effect(&self) -> Vec<(&'static str, String, String)> {
        let set = |setting: &Setting| {
            if let Some(value) = env::var_os(setting.variable) {
                let source = format!("variable {}", setting.variable);
                return Some((setting.name, value.to_string_lossy().into_owned(), source));
            }
            let entry = self.entry(setting.name)?;
            Some((setting.name, entry.value.clone(), entry.file.display().to_string()))
        };
        SETTINGS.iter().filter_map(set).collect()
    }

    /// Lets the options of `command` and its subcommands take their defaults from variables and files.
    pub(crate) fn apply(&self, mut command: clap::Command) -> clap::Command {
        let names: Vec<String> =
            command.get_subcommands().map(|sub| sub.get_name().to_owned()).collect();
        for name in names {
            command = command.mut_subcommand(name, |sub| self.apply(sub));
        }
        for setting in &SETTINGS {
            let has = command.get_arguments().find(|arg| arg.get_long() == Some(setting.name));
            let Some(id) = has.map(|arg| arg.get_id().clone()) else { continue };
            if EXCEPT.contains(&(command.get_name(), setting.name)) {
                continue;
            }
            let entry = self.entry(setting.name);
            command = command.mut_arg(id, |arg| {
                let arg = arg.env(setting.variable).hide_env(true);
                match entry {
                    Some(entry) => arg.required(false).default_value(entry.value.clone()),
                    None => arg,
                }
            });
        }
        command
    }

    /// The file and the setting in it that an error of the command line is about, if it is a file's.
    pub(crate) fn blamed(&self, error: &clap::Error) -> Option<CliError> {
        let text = |kind| match error.get(kind) {
            Some(ContextValue::String(text)) => Some(text.as_str()),
            _ => None,
        };
        let (arg, value) = (text(ContextKind::InvalidArg)?, text(ContextKind::InvalidValue)?);
        let name = arg.split_whitespace().next()?.trim_start_matches("--");
        let entry = self.entry(name).filter(|entry| entry.value == value)?;
        let typed = format!("--{name}");
        let is_typed = env::args_os().any(|word| word.to_string_lossy().starts_with(&typed));
        if is_typed || SETTINGS.iter().any(|s| s.name == name && env::var_os(s.variable).is_some())
        {
            return None;
        }
        Some(wrong(&entry.file, &format!("{name} = \"{value}\" is not understood")))
    }
}

/// The files that there are, the one that counts more first.
fn files() -> Vec<PathBuf> {
    let project = match env::var_os(FILE_VARIABLE) {
        Some(name) if name.is_empty() => return Vec::new(),
        Some(name) => Some(PathBuf::from(name)),
        None => env::current_dir().ok().and_then(|folder| above(&folder)),
    };
    let user = user_file().filter(|file| file.is_file());
    project.into_iter().chain(user).collect()
}

fn above(folder: &Path) -> Option<PathBuf> {
    folder.ancestors().map(|folder| folder.join(PROJECT_FILE)).find(|file| file.is_file())
}

/// Where the user's own file is, by the rules of the system.
pub(crate) fn user_file() -> Option<PathBuf> {
    let set = |name| env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let home = || set("HOME").map(|home| home.join(".config"));
    let base = set("XDG_CONFIG_HOME").or_else(|| set("APPDATA")).or_else(home)?;
    Some(base.join("wmr").join("config.toml"))
}

/// What the text of a file sets.
fn entries(text: &str, file: &Path) -> Result<Vec<Entry>, CliError> {
    let table: toml::Table =
        text.parse().map_err(|error: toml::de::Error| wrong(file, error.message()))?;
    let mut entries = Vec::new();
    for (key, value) in &table {
        let Some(setting) = SETTINGS.iter().find(|setting| setting.name == key) else {
            let known: Vec<&str> = SETTINGS.iter().map(|setting| setting.name).collect();
            return Err(wrong(
                file,
                &format!("{key} is no setting; there are {}", known.join(", ")),
            ));
        };
        let value = match value {
            toml::Value::String(text) => text.clone(),
            toml::Value::Integer(number) => number.to_string(),
            toml::Value::Float(number) => number.to_string(),
            _ => return Err(wrong(file, &format!("{key} must be a text or a number"))),
        };
        let value = if setting.is_path { beside(file, &value) } else { value };
        entries.push(Entry { name: setting.name, value, file: file.to_owned() });
    }
    Ok(entries)
}

/// A path in a file is meant from the file's folder.
fn beside(file: &Path, path: &str) -> String {
    let path: OsString = file.parent().unwrap_or(Path::new("")).join(path).into();
    path.to_string_lossy().into_owned()
}

fn wrong(file: &Path, why: &str) -> CliError {
    let message = format!("{}: {why}", file.display());
    let help = "write lines such as port = \"sim\" or arena = \"1.6x2.0\"; WMR_CONFIG= (set to nothing) passes the files over";
    CliError::new(Exit::File, "settings", message, help)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn a_file_s_paths_are_meant_from_its_folder_and_numbers_need_no_quotes() {
        let text = "camera = \"cam.json\"\nradius = 0.1\narena = \"1x2\"";
        let found = entries(text, Path::new("/lab/wmr.toml")).unwrap();
        let value = |name| found.iter().find(|entry| entry.name == name).unwrap().value.as_str();
        assert_eq!(
            [value("camera"), value("radius"), value("arena")],
            ["/lab/cam.json", "0.1", "1x2"]
        );
    }

    #[test]
    fn what_is_no_setting_is_refused_by_its_name() {
        for (text, word) in [("prot = 1", "prot"), ("port = [1]", "port"), ("port = ", "wmr.toml")]
        {
            let error = entries(text, Path::new("wmr.toml")).unwrap_err();
            assert!(error.message.contains(word), "{error:?}");
        }
    }

    #[test]
    fn every_setting_is_an_option_of_some_command() {
        fn has(command: &clap::Command, name: &str) -> bool {
            command.get_arguments().any(|arg| arg.get_long() == Some(name))
                || command.get_subcommands().any(|sub| has(sub, name))
        }
        let command = super::super::args::Cli::command();
        for Setting { name, variable, .. } in &SETTINGS {
            assert!(has(&command, name), "{name}");
            assert_eq!(*variable, format!("WMR_{}", name.to_uppercase().replace('-', "_")));
        }
    }

    #[test]
    fn the_nearest_project_file_upwards_is_found() {
        let folder = tempfile::tempdir().unwrap();
        let deep = folder.path().join("a/b");
        std::fs::create_dir_all(&deep).unwrap();
        std::fs::write(folder.path().join("a").join(PROJECT_FILE), "").unwrap();
        assert_eq!(above(&deep), Some(folder.path().join("a").join(PROJECT_FILE)));
    }
}
