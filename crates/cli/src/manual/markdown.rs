//! All commands on one page of Markdown.

use std::fmt::Write;

use clap::{Arg, Command};

const BEGIN: &str = "\
# Commands

<!-- Written by `phalanx man --markdown docs/reference/commands.md`; a test holds it to the program. -->
";

/// The page of a program that is built.
pub(super) fn page(program: &Command) -> String {
    let mut page = BEGIN.to_owned();
    for command in commands(program) {
        section(&mut page, command).expect("writing to a string");
    }
    page
}

fn section(page: &mut String, command: &Command) -> std::fmt::Result {
    let name = command.get_bin_name().unwrap_or(command.get_name());
    writeln!(page, "\n## {name}\n")?;
    if let Some(about) = command.get_long_about().or(command.get_about()) {
        writeln!(page, "{}\n", sentence(&about.to_string()))?;
    }
    let usage = command.clone().render_usage().to_string();
    writeln!(page, "```console\n$ {}\n```", usage.trim_start_matches("Usage: ").trim_end())?;
    let (arguments, options): (Vec<&Arg>, Vec<&Arg>) =
        command.get_arguments().filter(|arg| is_own(arg)).partition(|arg| arg.is_positional());
    table(page, "argument", arguments.into_iter().map(row))?;
    table(page, "option", options.into_iter().map(row))?;
    table(page, "command", command.get_subcommands().map(entry))
}

/// A command and all below it, in the order of their help.
fn commands(command: &Command) -> Vec<&Command> {
    std::iter::once(command).chain(command.get_subcommands().flat_map(commands)).collect()
}

fn is_own(arg: &Arg) -> bool {
    !arg.is_hide_set() && !["help", "version"].contains(&arg.get_id().as_str())
}

fn table(
    page: &mut String,
    head: &str,
    rows: impl Iterator<Item = [String; 2]>,
) -> std::fmt::Result {
    let rows: Vec<[String; 2]> = rows.collect();
    if rows.is_empty() {
        return Ok(());
    }
    writeln!(page, "\n| {head} | what it does |\n|---|---|")?;
    for [name, help] in rows {
        writeln!(page, "| {name} | {} |", cell(&help))?;
    }
    Ok(())
}

/// An argument's name and its help with default and choices.
fn row(arg: &Arg) -> [String; 2] {
    let values = arg.get_value_names().unwrap_or_default();
    let values: Vec<String> = values.iter().map(|name| format!("<{name}>")).collect();
    let takes_value = arg.get_action().takes_values();
    let name = match arg.get_long() {
        Some(long) if takes_value => format!("`--{long} {}`", values.join(" ")),
        Some(long) => format!("`--{long}`"),
        None => format!("`{}`", values.join(" ")),
    };
    let help = arg.get_long_help().or(arg.get_help()).map(ToString::to_string);
    let mut help = sentence(&help.unwrap_or_default());
    let choices = if takes_value { arg.get_possible_values() } else { Vec::new() };
    for choice in choices.iter().filter(|choice| !choice.is_hide_set()) {
        let about = choice.get_help().map(|about| format!(": {about}")).unwrap_or_default();
        write!(help, "<br>`{}`{about}", choice.get_name()).expect("writing to a string");
    }
    let defaults: Vec<String> =
        arg.get_default_values().iter().map(|value| format!("`{}`", value.display())).collect();
    if takes_value && !defaults.is_empty() {
        write!(help, "<br>Default: {}", defaults.join(" ")).expect("writing to a string");
    }
    [name.replace('|', "\\|"), help]
}

/// A command in the list of the command above it.
fn entry(command: &Command) -> [String; 2] {
    let name = command.get_bin_name().unwrap_or(command.get_name());
    let about = command.get_about().map(ToString::to_string).unwrap_or_default();
    [format!("[{name}](#{})", name.replace(' ', "-")), about]
}

/// Help begins without a full stop in clap's short form.
fn sentence(text: &str) -> String {
    let text = text.trim();
    if text.ends_with('.') { text.to_owned() } else { format!("{text}.") }
}

/// Text in a table's cell.
fn cell(text: &str) -> String {
    sentence(text).replace('|', "\\|").replace("\n\n", "<br>").replace('\n', " ")
}
