//! burnish: look at microfacet BRDFs in a path-traced picture that gets better as you watch.

#[cfg(test)]
#[path = "../tests/support/bounded.rs"]
mod bounded;
mod cli;
#[cfg(test)]
#[path = "../tests/support/mutate.rs"]
mod mutate;
mod numbers;
mod shell;
#[cfg(feature = "viewer")]
mod viewer;

fn main() -> std::process::ExitCode {
    cli::main()
}
