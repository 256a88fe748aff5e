within Signal.Bases;
partial block Tabular "A table written in the model, or read from a file"
  parameter String fileName = "" "File that holds the table (CSV, or Modelica's text format); empty: the table is written here";
  parameter String tableName = "" "Name of the table in a file of the text format; empty: the first";
end Tabular;
