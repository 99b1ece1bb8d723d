//! The one binary of integration tests: what is seen from outside.

#[cfg(test)]
mod command;
