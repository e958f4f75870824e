//! The command line: arguments -> subcommand -> exit code.
//!
//! 0 when all that was asked for is done, 1 when it failed, 2 when the arguments make no sense
//! (clap's own code). Results go to stdout, all talk to stderr.

mod brdf;
mod check;
mod checkpoint;
mod compare;
mod completions;
mod info;
mod interrupt;
mod jobs;
mod memory;
mod merge;
mod numbers;
mod outputs;
mod pictures;
mod pixel;
mod progress;
mod render;
mod report;
mod resume;
mod scene;
mod settings;
mod sheet;
mod snapshots;
mod soak;
mod stats;
mod talk;
mod trace;
mod values;
mod verify;
mod window;

use burnish::plain;
use burnish::scene::builtin::{EXAMPLES as EXAMPLE_SCENES, Example};
use clap::{CommandFactory, Parser, Subcommand};
use std::fmt::Display;
use std::io::{self, Write};
use std::process::ExitCode;
use std::time::Instant;
use talk::{Volume, say};

const EXAMPLES: &str = "Examples:
  burnish                                   the built-in scene in the window
  burnish table.scn                         a scene of yours
  burnish render table.scn -o table.png     the same without a window
  burnish help render                       all about a subcommand";

/// What is refused for its size, in words.
fn limits() -> String {
    let row = |(what, how_much): (&str, String)| format!("\n  {what}: {how_much}");
    format!("Limits:{}", burnish::limits::table().into_iter().map(row).collect::<String>())
}

/// The shipped scenes, each with what to look for in it.
fn scenes() -> String {
    let row = |scene: &Example| {
        let caption = scene.caption().unwrap_or(scene.shows);
        format!("\n  {:<8} {caption}", scene.name)
    };
    format!("Shipped scenes:{}", EXAMPLE_SCENES.iter().map(row).collect::<String>())
}

/// Shows how Phong, Beckmann and GGX surfaces look, in a path-traced picture that gets better as
/// you watch. Without a subcommand it opens the window.
#[derive(Debug, Parser)]
#[command(name = "burnish", version)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{}\n\n{}", scenes(), limits()))]
struct Args {
    /// Says nothing but errors.
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    quiet: bool,
    /// Says more: what is in the scene, threads, instruction set, times.
    #[arg(short, long, global = true)]
    verbose: bool,
    #[command(flatten)]
    window: window::Args,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    Brdf(brdf::Args),
    Check(check::Args),
    Compare(compare::Args),
    Completions(completions::Args),
    Info(info::Args),
    Merge(merge::Args),
    Pixel(Box<pixel::Args>),
    Render(Box<render::Args>),
    Report(report::Args),
    Resume(resume::Args),
    Sheet(Box<sheet::Args>),
    Soak(soak::Args),
    Verify(verify::Args),
}

/// Runs the subcommand that the arguments name.
pub(crate) fn main() -> ExitCode {
    let started = Instant::now();
    let args = Args::parse();
    memory::begin(matches!(args.command, None | Some(Command::Soak(_))));
    // Not by clap's own rule, which would forbid --quiet before a subcommand too.
    if args.command.is_some() && args.window != window::Args::default() {
        misused("a scene or an argument of the window stands before the subcommand");
    }
    if args.quiet {
        talk::set(Volume::Quiet);
    } else if args.verbose {
        talk::set(Volume::Verbose);
    }
    let result = match args.command {
        None => window::open(args.window),
        Some(Command::Brdf(args)) => brdf::run(&args),
        Some(Command::Check(args)) => check::run(&args),
        Some(Command::Compare(args)) => compare::run(&args),
        Some(Command::Completions(args)) => completions::run(&args),
        Some(Command::Info(args)) => info::run(&args),
        Some(Command::Merge(args)) => merge::run(&args),
        Some(Command::Pixel(args)) => pixel::run(&args),
        Some(Command::Render(args)) => render::run(&args, started),
        Some(Command::Report(args)) => report::run(&args),
        Some(Command::Resume(args)) => resume::run(&args, started),
        Some(Command::Sheet(args)) => sheet::run(&args),
        Some(Command::Soak(args)) => soak::run(&args),
        Some(Command::Verify(args)) => verify::run(&args, started),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure(text)) => {
            // A line for each error of a file.
            text.iter().flat_map(|text| text.lines()).for_each(talk::error);
            ExitCode::FAILURE
        }
    }
}

/// The arguments that there are.
fn command() -> clap::Command {
    Args::command()
}

/// Ends the program as clap does where arguments make no sense together: exit code 2.
fn misused(text: impl Display) -> ! {
    command().error(clap::error::ErrorKind::ValueValidation, text).exit()
}

/// Why nothing came of it, in one line that says what to do, or one for each of a file's errors:
/// exit code 1. `None` when whoever
/// read stdout has left, as `head` does: there is nobody to tell.
#[derive(Debug)]
struct Failure(Option<String>);

impl Failure {
    fn new(text: impl Display) -> Failure {
        Failure(Some(text.to_string()))
    }
}

impl From<io::Error> for Failure {
    /// An error of writing to stdout.
    fn from(e: io::Error) -> Failure {
        let gone = e.kind() == io::ErrorKind::BrokenPipe;
        Failure((!gone).then(|| format!("cannot write to stdout: {e}")))
    }
}

/// A line on stdout, or several. What a file brought into it cannot steer the terminal.
fn print(line: impl Display) -> Result<(), Failure> {
    Ok(writeln!(io::stdout().lock(), "{}", plain::lines(&line.to_string()))?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The commands of a page: lines of its blocks, and what it names with an option within its text.
    fn commands(page: &str) -> Vec<String> {
        let (mut found, mut text, mut block) = (Vec::new(), String::new(), false);
        for line in page.lines() {
            if line.starts_with("```") {
                block = !block;
            } else if block {
                found.push(line.split("  #").next().unwrap_or(line).to_owned());
            } else {
                text += line;
                text.push(' ');
            }
        }
        found.extend(
            text.split('`').skip(1).step_by(2).filter(|c| c.contains(" -")).map(String::from),
        );
        found.retain(|command| command.starts_with("burnish "));
        found
    }

    #[test]
    fn commands_on_pages_are_understood() {
        let pages = [
            include_str!("../../README.md"),
            include_str!("COMMANDS.md"),
            include_str!("../measure/accuracy.md"),
            include_str!("../measure/errata.md"),
            include_str!("../measure/speed.md"),
        ];
        let all: Vec<String> = pages.into_iter().flat_map(commands).collect();
        assert!(all.len() > 50, "only {} commands found", all.len());
        for command in all {
            let words = command.replace(" NAME", " ggx-g-sum");
            let parsed = Args::try_parse_from(words.split_whitespace());
            // A help that is asked for is not a mistake.
            let refused = parsed.err().filter(clap::Error::use_stderr).map(|e| e.to_string());
            assert_eq!(refused, None, "{command}");
        }
        for subcommand in command().get_subcommands().map(clap::Command::get_name) {
            let is_there = pages[1].contains(&format!("burnish {subcommand} "));
            assert!(is_there, "COMMANDS.md lacks {subcommand}");
        }
    }
}
