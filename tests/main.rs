//! One test binary: every topic is a folder, and README.md says what proves what.

mod normal;
mod oracle;
mod sabotage;
mod stream;
mod support;
