//! Diagnostics as text: human, short and JSON.
