//! Tests of the command, the page, the language server, units for other tools.

mod cli;
mod lsp;
mod parquet;
mod serve;
mod units;
