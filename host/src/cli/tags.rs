//! `wmr tags`: a sheet of tags to print.

use super::args::TagsArgs;
use super::error::CliError;
use super::folder::write_named;
use super::output::Output;
use wmr::document::TagsDocument;
use wmr::picture::tags::tag_sheet;
use wmr::vision::TagDictionary;

/// `wmr tags`.
pub(crate) fn run(args: &TagsArgs, output: Output) -> Result<(), CliError> {
    let dictionary = TagDictionary::named(&args.dictionary).ok_or_else(|| {
        let known: Vec<String> = TagDictionary::usual().iter().map(TagDictionary::name).collect();
        CliError::usage(
            format!("{:?} is no dictionary of tags", args.dictionary),
            format!("give one of {}, or a smaller one such as 4X4_50", known.join(", ")),
        )
    })?;
    let millimetres = args.size * 1000.0;
    let sheet = tag_sheet(dictionary, &args.ids, args.size).ok_or_else(|| {
        CliError::usage(
            format!(
                "{} tags of {millimetres:.0} mm with these numbers make no sheet of A4",
                args.ids.len()
            ),
            format!("give fewer or smaller ones, with numbers below {}", dictionary.len()),
        )
    })?;
    write_named(&args.out, sheet.as_bytes(), "drawing", |older| older.starts_with(b"<svg"))?;
    let name = args.out.display().to_string();
    let text = format!(
        "{name}: {} tags of {millimetres:.0} mm; print it at 100 % and check the ruler\n",
        args.ids.len()
    );
    let document = TagsDocument {
        file: name,
        dictionary: dictionary.name(),
        ids: args.ids.clone(),
        size: args.size,
    };
    output.result(&document, &text)
}
