//! Ray projection cone
