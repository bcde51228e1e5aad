"""Contacts that open and close: when, and how joints and waves move with them."""
